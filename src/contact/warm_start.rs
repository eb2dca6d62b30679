//! Which contacts carried an impulse in the last substep: the guess for the next one.

use super::Contact;
use super::contact::ContactKey;

/// A contact that carried an impulse, and the impulse in cm/s.
pub(crate) type CachedImpulse = (ContactKey, f64);

/// The contacts and impulses of one substep, to be looked up by contact.
#[derive(Debug, Clone, Default)]
pub(super) struct WarmStartCache {
    /// In the order of detection; contacts without an impulse may be missing.
    entries: Vec<CachedImpulse>,
    /// The last entry of each boat, and for each entry the one before it of the same boat.
    of_boat: Vec<u32>,
    before: Vec<u32>,
}

const NONE: u32 = u32::MAX;
/// How many entries are passed over in search of a contact: those of contacts that are gone.
const AHEAD: usize = 4;

impl WarmStartCache {
    /// All entries in the order of detection; some impulses are zero.
    pub(super) fn impulses(&self) -> &[CachedImpulse] {
        &self.entries
    }

    /// Forgets all contacts.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    /// Replaces all contacts and their impulses.
    pub(super) fn replace(&mut self, entries: impl Iterator<Item = CachedImpulse>) {
        self.entries.clear();
        self.entries.extend(entries);
    }

    /// The impulse that each contact carried, 0 if it carried none, in a flock of so many boats. Where an end
    /// slides off the other hull's end onto its side, a contact changes its name and continues: it inherits the
    /// impulse of a contact of the same two that is there no more.
    ///
    /// Contacts mostly come in the order of the last substep, a few gone and a few new.
    pub(super) fn lookup(&mut self, boats: usize, contacts: &[Contact], impulses: &mut Vec<f64>) {
        impulses.clear();
        let mut next = 0;
        let mut is_indexed = false;
        for (k, contact) in contacts.iter().enumerate() {
            let key = contact.key();
            let mut place = next;
            let last = self.entries.len().min(next + AHEAD);
            while place < last && !is_same(self.entries[place].0, key) {
                place += 1;
            }
            let impulse = if place < last {
                next = place + 1;
                let impulse = self.entries[place].1;
                if impulse > 0.0 || !contact.has_ends() {
                    impulse.max(0.0)
                } else {
                    self.inherited(contacts, k, place)
                }
            } else if self.entries.is_empty() {
                0.0
            } else {
                if !is_indexed {
                    self.index(boats);
                    is_indexed = true;
                }
                self.search(contacts, k)
            };
            impulses.push(impulse);
        }
    }

    /// The impulse that contact k inherits from its pair's other entry, beside its own.
    fn inherited(&self, contacts: &[Contact], k: usize, place: usize) -> f64 {
        let beside = [place.checked_sub(1), Some(place + 1)];
        let beside = beside.into_iter().flatten();
        beside
            .filter_map(|other| self.entries.get(other))
            .find(|entry| is_heir(contacts, k, entry))
            .map_or(0.0, |&(_, impulse)| impulse)
    }

    // Out of line, like the search, so that looking up contacts in order stays in registers.
    #[inline(never)]
    fn index(&mut self, boats: usize) {
        self.of_boat.clear();
        self.of_boat.resize(boats, NONE);
        self.before.clear();
        for (place, ((boat, _, _), _)) in self.entries.iter().enumerate() {
            let last = &mut self.of_boat[*boat as usize];
            self.before.push(std::mem::replace(last, place as u32));
        }
    }

    /// The impulse of contact k, wherever it is.
    #[inline(never)]
    fn search(&self, contacts: &[Contact], k: usize) -> f64 {
        let key = contacts[k].key();
        let mut inherited = 0.0;
        let mut place = self.of_boat[key.0 as usize];
        while let Some(entry) = self.entries.get(place as usize) {
            if entry.0 == key && entry.1 > 0.0 {
                return entry.1;
            }
            if is_heir(contacts, k, entry) {
                inherited = entry.1;
            }
            place = self.before[place as usize];
        }
        inherited
    }
}

/// Equality of keys, without the branches of comparing tuples and choices.
#[inline]
fn is_same(a: ContactKey, b: ContactKey) -> bool {
    (a.0 == b.0) & (a.2 == b.2) && a.1 == b.1
}

/// Whether contact k continues with an entry's impulse under another name.
fn is_heir(contacts: &[Contact], k: usize, &(known, impulse): &CachedImpulse) -> bool {
    let key = contacts[k].key();
    if !(impulse > 0.0 && (known.0, known.1) == (key.0, key.1) && contacts[k].has_ends()) {
        return false;
    }
    // A pair has at most two contacts, which are found one after the other.
    let near = &contacts[k.saturating_sub(1)..(k + 2).min(contacts.len())];
    near.iter().all(|other| other.key() != known)
}
