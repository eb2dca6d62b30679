//! Which contacts carried an impulse in the last substep: the guess for the next one.

use super::Contact;
use super::contact::ContactKey;

/// A contact that carried an impulse, and the impulse in cm/s.
pub type Load = (ContactKey, f64);

/// The loads of one substep, to be looked up by contact.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    loads: Vec<Load>,
    /// The last load of each boat, and for each load the one before it of the same boat.
    of_boat: Vec<u32>,
    before: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Loads {
    /// All loads, in the order they were given.
    pub fn as_slice(&self) -> &[Load] {
        &self.loads
    }

    /// Forgets all loads.
    pub fn clear(&mut self) {
        self.loads.clear();
    }

    /// Replaces the loads; impulses of 0 carry nothing and are left out.
    pub fn replace(&mut self, loads: impl Iterator<Item = Load>) {
        self.loads.clear();
        self.loads
            .extend(loads.filter(|&(_, impulse)| impulse > 0.0));
    }

    /// Makes [`Self::recall`] ready for a flock of so many boats.
    pub fn index(&mut self, boats: usize) {
        self.of_boat.clear();
        self.of_boat.resize(boats, NONE);
        self.before.clear();
        for (place, ((boat, _, _), _)) in self.loads.iter().enumerate() {
            let last = &mut self.of_boat[*boat as usize];
            self.before.push(std::mem::replace(last, place as u32));
        }
    }

    /// The impulse that contact k carried; 0 if it carried none. Where an end slides off the other
    /// hull's end onto its side, a contact changes its name and goes on: it inherits the load of a
    /// contact between the same boats that is there no more.
    pub fn recall(&self, contacts: &[Contact], k: usize) -> f64 {
        let key = contacts[k].key();
        let is_pair = contacts[k].second().is_some();
        // A pair has at most two contacts, which are found one after the other.
        let near = &contacts[k.saturating_sub(1)..(k + 2).min(contacts.len())];
        let mut inherited = 0.0;
        let mut place = self.of_boat[key.0 as usize];
        while let Some(&(known, impulse)) = self.loads.get(place as usize) {
            if known == key {
                return impulse;
            }
            if is_pair && known.1 == key.1 && near.iter().all(|other| other.key() != known) {
                inherited = impulse;
            }
            place = self.before[place as usize];
        }
        inherited
    }
}
