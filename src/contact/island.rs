//! Islands: boats joined by contacts. Each is a contact problem of its own.

use super::Contact;
use std::ops::Range;

/// Contacts grouped by island, each group in the order of detection.
#[derive(Debug, Clone, Default)]
pub struct Islands {
    /// Union-find over boats.
    parent: Vec<u32>,
    /// Island of each requested boat.
    island_of_boat: Vec<u32>,
    /// Where each island begins in `members`.
    starts: Vec<u32>,
    /// Contact indices, island by island.
    members: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Islands {
    /// Finds the islands of a flock of `boats` boats. Walls join nothing.
    pub fn find(&mut self, boats: usize, contacts: &[Contact]) {
        self.parent.clear();
        self.parent.extend(0..boats as u32);
        for contact in contacts {
            if let Some(second) = contact.second() {
                let (a, b) = (self.root(contact.boat), self.root(second as u32));
                self.parent[a.max(b) as usize] = a.min(b);
            }
        }
        // First the sizes, then the members: a counting sort by island.
        self.island_of_boat.clear();
        self.island_of_boat.resize(boats, NONE);
        self.starts.clear();
        self.starts.push(0);
        for contact in contacts {
            let island = self.island_of(contact.boat);
            self.starts[island + 1] += 1;
        }
        for island in 1..self.starts.len() {
            self.starts[island] += self.starts[island - 1];
        }
        self.members.clear();
        self.members.resize(contacts.len(), 0);
        for (k, contact) in contacts.iter().enumerate() {
            let next = &mut self.starts[self.island_of_boat[contact.boat as usize] as usize];
            self.members[*next as usize] = k as u32;
            *next += 1;
        }
        // Filling moved every start to its island's end.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// The island of a boat that has a contact, numbered in the order of detection.
    fn island_of(&mut self, boat: u32) -> usize {
        let known = self.island_of_boat[boat as usize];
        if known != NONE {
            return known as usize;
        }
        let root = self.root(boat) as usize;
        if self.island_of_boat[root] == NONE {
            self.island_of_boat[root] = self.starts.len() as u32 - 1;
            self.starts.push(0);
        }
        self.island_of_boat[boat as usize] = self.island_of_boat[root];
        self.island_of_boat[root] as usize
    }

    /// How many islands have contacts.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there is no island.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Contact indices, island by island.
    pub fn all_contacts(&self) -> &[u32] {
        &self.members
    }

    /// Where the contacts of an island stand in [`Self::all_contacts`].
    pub fn range(&self, island: usize) -> Range<usize> {
        self.starts[island] as usize..self.starts[island + 1] as usize
    }

    /// The contacts of an island.
    pub fn contacts(&self, island: usize) -> &[u32] {
        &self.members[self.range(island)]
    }

    fn root(&mut self, boat: u32) -> u32 {
        let mut boat = boat as usize;
        while self.parent[boat] as usize != boat {
            self.parent[boat] = self.parent[self.parent[boat] as usize];
            boat = self.parent[boat] as usize;
        }
        boat as u32
    }
}
