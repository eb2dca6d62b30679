//! Which contacts carried an impulse in the last substep: the guess for the next one.

use super::Contact;
use super::contact::ContactKey;

/// A contact that carried an impulse, and the impulse in cm/s.
pub type CachedImpulse = (ContactKey, f64);

/// The impulses of one substep, to be looked up by contact.
#[derive(Debug, Clone, Default)]
pub struct WarmStartCache {
    impulses: Vec<CachedImpulse>,
    /// The last impulse of each boat, and for each impulse the one before it of the same boat.
    of_boat: Vec<u32>,
    before: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl WarmStartCache {
    /// All impulses, in the order they were given.
    pub fn as_slice(&self) -> &[CachedImpulse] {
        &self.impulses
    }

    /// Forgets all impulses.
    pub fn clear(&mut self) {
        self.impulses.clear();
    }

    /// Replaces the impulses; those of 0 are left out.
    pub fn replace(&mut self, impulses: impl Iterator<Item = CachedImpulse>) {
        self.impulses.clear();
        self.impulses
            .extend(impulses.filter(|&(_, impulse)| impulse > 0.0));
    }

    /// Makes [`Self::lookup`] ready for a flock of so many boats.
    pub fn index(&mut self, boats: usize) {
        self.of_boat.clear();
        self.of_boat.resize(boats, NONE);
        self.before.clear();
        for (place, ((boat, _, _), _)) in self.impulses.iter().enumerate() {
            let last = &mut self.of_boat[*boat as usize];
            self.before.push(std::mem::replace(last, place as u32));
        }
    }

    /// The impulse that contact k carried; 0 if it carried none. Where an end slides off the other
    /// hull's end onto its side, a contact changes its name and goes on: it inherits the impulse of a
    /// contact between the same boats that is there no more.
    pub fn lookup(&self, contacts: &[Contact], k: usize) -> f64 {
        let key = contacts[k].key();
        let is_pair = contacts[k].second().is_some();
        // A pair has at most two contacts, which are found one after the other.
        let near = &contacts[k.saturating_sub(1)..(k + 2).min(contacts.len())];
        let mut inherited = 0.0;
        let mut place = self.of_boat[key.0 as usize];
        while let Some(&(known, impulse)) = self.impulses.get(place as usize) {
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
