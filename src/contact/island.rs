//! Islands: boats joined by contacts. Each is a separate contact problem.

use super::{Contact, Partner};

/// Contacts grouped by island, each group in the order of detection.
#[derive(Debug, Clone, Default)]
pub struct Islands {
    /// Union-find over boats.
    parent: Vec<u32>,
    /// For the first boat of each island, the island's index; [`NONE`] for other boats.
    island_of_root: Vec<u32>,
    island_of_contact: Vec<u32>,
    /// Start of each island in `members`.
    starts: Vec<u32>,
    /// Contact indices, island by island.
    members: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Islands {
    /// Groups contacts into islands, numbered in the order of their first contacts. `boats` is the number of boats. A wall
    /// joins no boats.
    pub fn find(&mut self, boats: usize, contacts: &[Contact]) {
        self.join(boats, contacts);
        // A counting sort by island: `starts[island + 1]` first counts the island's contacts.
        self.island_of_root.clear();
        self.island_of_root.resize(boats, NONE);
        self.island_of_contact.resize(contacts.len(), 0);
        self.starts.clear();
        self.starts.push(0);
        for (contact, contact_island) in contacts.iter().zip(&mut self.island_of_contact) {
            let root = self.parent[contact.boat as usize];
            let island = &mut self.island_of_root[root as usize];
            if *island == NONE {
                *island = self.starts.len() as u32 - 1;
                self.starts.push(0);
            }
            *contact_island = *island;
            self.starts[*island as usize + 1] += 1;
        }
        // Then `starts[island + 1]` holds the index of the island's first member. It moves to the island's end as members are
        // added.
        let mut first = 0;
        for start in &mut self.starts[1..] {
            first += std::mem::replace(start, first);
        }
        self.members.resize(contacts.len(), 0);
        for (k, &island) in self.island_of_contact.iter().enumerate() {
            let next = &mut self.starts[island as usize + 1];
            self.members[*next as usize] = k as u32;
            *next += 1;
        }
    }

    /// Sets every boat's parent to the first boat of its island.
    fn join(&mut self, boats: usize, contacts: &[Contact]) {
        self.parent.clear();
        self.parent.extend(0..boats as u32);
        // Of known length, so that the loop over boats has no bounds check for them.
        let parent = &mut self.parent[..boats];
        for contact in contacts {
            if let Partner::Boat(second) = contact.partner {
                join(parent, contact.boat, second);
            }
        }
        // Parents come before their children, so a parent's own parent is already the first boat.
        for boat in 0..boats {
            parent[boat] = parent[parent[boat] as usize];
        }
    }

    /// Number of islands with contacts.
    pub fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Indices of an island's contacts.
    pub fn contacts(&self, island: usize) -> &[u32] {
        let ends = &self.starts[island..island + 2];
        &self.members[ends[0] as usize..ends[1] as usize]
    }
}

/// Joins the sets of two boats. The root of a set is its first boat.
#[inline]
pub(crate) fn join(parent: &mut [u32], a: u32, b: u32) {
    // Two boats that touch twice, for example, are already joined.
    if parent[a as usize] == parent[b as usize] {
        return;
    }
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

/// The first boat of a boat's set. Shortens the path to it on the way.
pub(crate) fn root(parent: &mut [u32], mut boat: u32) -> u32 {
    loop {
        let above = parent[boat as usize];
        if above == boat {
            return boat;
        }
        let next = parent[above as usize];
        parent[boat as usize] = next;
        boat = next;
    }
}
