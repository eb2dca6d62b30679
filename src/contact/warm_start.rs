//! Impulses of the last substep's contacts, which guess those of the next substep.

use super::touches::{TouchPosition, distance, position};
use super::{Contact, Partner};

/// A contact of the last substep with the impulse that it carried.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct CachedImpulse {
    /// The boat that the normal pushed.
    pub boat: u32,
    /// The other side.
    pub partner: Partner,
    /// Position of the touch along both cores.
    position: TouchPosition,
    /// In cm/s; 0 if the contact carried none.
    pub impulse: f64,
}

impl CachedImpulse {
    /// A contact that carried an impulse.
    pub(super) fn new(contact: &Contact, impulse: f64) -> Self {
        Self {
            boat: contact.boat,
            partner: contact.partner,
            position: position(&contact.gap),
            impulse,
        }
    }

    /// Whether its impulse and position are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.impulse.is_finite() && self.position.iter().all(|along| along.is_finite())
    }

    #[inline]
    fn has_same_bodies(&self, contact: &Contact) -> bool {
        (self.boat == contact.boat) && self.partner == contact.partner
    }

    /// Whether the impulse was nearer to `contact` than to `other`.
    #[inline]
    fn is_nearer(&self, contact: &Contact, other: &Contact) -> bool {
        let distance_to = |contact: &Contact| distance(position(&contact.gap), self.position);
        distance_to(contact) < distance_to(other)
    }
}

/// The contacts and impulses of one substep, looked up by contact.
#[derive(Debug, Clone, Default)]
pub(super) struct WarmStartCache {
    /// Entries in the order of detection, with the contacts of a pair one after the other. Contacts without an impulse
    /// may be missing.
    entries: Vec<CachedImpulse>,
    /// Index of each boat's last entry, or [`NONE`].
    last_of_boat: Vec<u32>,
    /// For each entry, the index of the previous entry of the same boat, or [`NONE`].
    previous: Vec<u32>,
}

const NONE: u32 = u32::MAX;
/// Number of entries that a lookup tests before it searches among all entries of a boat.
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

    /// Fills `impulses` with the impulse that each contact carried, or 0. Each impulse goes to the nearest
    /// contact of the same two bodies.
    ///
    /// Contacts mostly come in the order of the last substep, with a few gone and a few new. So the search for a
    /// contact starts after the entries of the previous contact.
    pub(super) fn lookup(&mut self, contacts: &[Contact], impulses: &mut Vec<f64>) {
        impulses.clear();
        impulses.resize(contacts.len(), 0.0);
        if self.entries.is_empty() {
            return;
        }
        let (mut next_entry, mut is_indexed, mut k) = (0, false, 0);
        while let Some(contact) = contacts.get(k) {
            let end = self.entries.len().min(next_entry + AHEAD);
            let mut start = next_entry;
            while start < end && !self.entries[start].has_same_bodies(contact) {
                start += 1;
            }
            let entries = if start < end {
                let count = self.count_entries(start, contact);
                next_entry = start + count;
                &self.entries[start..next_entry]
            } else {
                if !is_indexed {
                    self.index();
                    is_indexed = true;
                }
                self.search(contact)
            };
            let second = contacts.get(k + 1).filter(|other| other.is_twin(contact));
            for entry in entries {
                if entry.impulse > 0.0 {
                    let is_second = second.is_some_and(|second| entry.is_nearer(second, contact));
                    impulses[k + usize::from(is_second)] += entry.impulse;
                }
            }
            k += 1 + usize::from(second.is_some());
        }
    }

    /// Number of entries, one or two, with the same two bodies as `contact`. The first of them is at index `start`.
    #[inline]
    fn count_entries(&self, start: usize, contact: &Contact) -> usize {
        let second = self.entries.get(start + 1);
        1 + usize::from(second.is_some_and(|entry| entry.has_same_bodies(contact)))
    }

    // Indexes the entries by boat. Neither this nor the search is inlined, so that the lookup of contacts that come in
    // order stays in registers.
    #[inline(never)]
    fn index(&mut self) {
        let boats = self.entries.iter().map(|entry| entry.boat as usize + 1);
        self.last_of_boat.clear();
        self.last_of_boat.resize(boats.max().unwrap_or(0), NONE);
        self.previous.clear();
        for (index, entry) in self.entries.iter().enumerate() {
            let last = &mut self.last_of_boat[entry.boat as usize];
            self.previous.push(std::mem::replace(last, index as u32));
        }
    }

    /// The entries with the same two bodies as a contact, found among those of its boat.
    #[inline(never)]
    fn search(&self, contact: &Contact) -> &[CachedImpulse] {
        let mut index = self
            .last_of_boat
            .get(contact.boat as usize)
            .copied()
            .unwrap_or(NONE);
        let mut first = None;
        while let Some(entry) = self.entries.get(index as usize) {
            if entry.has_same_bodies(contact) {
                first = Some(index as usize);
            } else if first.is_some() {
                break;
            }
            index = self.previous[index as usize];
        }
        first.map_or(&[], |first| {
            &self.entries[first..first + self.count_entries(first, contact)]
        })
    }
}
