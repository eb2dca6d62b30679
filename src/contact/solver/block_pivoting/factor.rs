//! The sparse factor A_FF = L·D·Lᵀ of an island's active rows F, row by row.
//!
//! A row of L has entries where its elimination tree says (Liu 1990): at the rows that it shares a boat with
//! and their ancestors before it. A change of F changes the rows that enter or leave and their ancestors, and
//! no others.

use super::rows::{NONE, Row, Rows};

/// An entry of L.
#[derive(Debug, Clone, Copy)]
struct Entry {
    column: u32,
    value: f64,
}

/// A row of L.
#[derive(Debug, Clone, Copy)]
struct Node {
    begin: u32,
    end: u32,
    /// The first row with an entry in this column.
    parent: u32,
    is_dirty: bool,
    inverse_pivot: f64,
    /// A row that is being computed; zero between two rows.
    work: f64,
}

const EMPTY: Node = Node {
    begin: 0,
    end: 0,
    parent: NONE,
    is_dirty: false,
    inverse_pivot: 0.0,
    work: 0.0,
};

/// The factor of one island.
#[derive(Debug, Clone, Default)]
pub struct Factor {
    nodes: Vec<Node>,
    entries: Vec<Entry>,
    /// How many numbers the rows hold.
    len: usize,
    first_dirty: usize,
    /// The columns of a row that is being computed, a bit each; zero between two rows.
    pattern: Vec<u64>,
}

impl Factor {
    /// The factor of no row, of an island with these rows, of which the active ones are wanted.
    pub fn reset(&mut self, rows: &[Row]) {
        self.nodes.clear();
        self.nodes.extend(rows.iter().map(|row| Node {
            is_dirty: row.is_active,
            ..EMPTY
        }));
        self.entries.clear();
        self.len = 0;
        self.first_dirty = 0;
        self.pattern.resize(rows.len() / 64 + 1, 0);
    }

    /// How many numbers the factor of the active rows holds.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Takes note that a row has entered or left the active ones.
    pub fn flip(&mut self, rows: &Rows, flipped: usize) {
        mark_dirty(&mut self.nodes, flipped as u32);
        self.first_dirty = self.first_dirty.min(flipped);
        let row = &rows.rows[flipped];
        if !row.is_active {
            return;
        }
        // Rows after it that share a boat.
        for body in row.bodies {
            let mut link = rows.bodies[body as usize].last;
            while link != NONE && link as usize / 2 > flipped {
                let other = &rows.rows[link as usize / 2];
                if other.is_active {
                    mark_dirty(&mut self.nodes, link / 2);
                }
                link = other.before[link as usize % 2];
            }
        }
    }

    /// Computes the rows that have changed; returns how many. `regularization` is added to the diagonal, relative to
    /// it.
    pub fn update(&mut self, rows: &[Row], regularization: f64) -> u64 {
        let mut computed = 0;
        let begin = std::mem::replace(&mut self.first_dirty, rows.len());
        for (k, row) in rows.iter().enumerate().skip(begin) {
            if !self.nodes[k].is_dirty {
                continue;
            }
            self.release(k as u32);
            if row.is_active {
                self.compute(rows, k, regularization);
                computed += 1;
            }
        }
        computed
    }

    /// Empties a row.
    fn release(&mut self, k: u32) {
        let Node { begin, end, .. } = self.nodes[k as usize];
        for entry in &self.entries[begin as usize..end as usize] {
            let parent = &mut self.nodes[entry.column as usize].parent;
            if *parent == k {
                *parent = NONE;
            }
        }
        let node = &mut self.nodes[k as usize];
        self.len -= (end - begin) as usize + usize::from(node.inverse_pivot > 0.0);
        (node.begin, node.end, node.inverse_pivot, node.is_dirty) = (0, 0, 0.0, false);
    }

    fn compute(&mut self, rows: &[Row], k: usize, regularization: f64) {
        let lowest = self.find_pattern(rows, k);
        let Self {
            nodes,
            entries,
            pattern,
            ..
        } = self;
        let nodes = nodes.as_mut_slice();
        let begin = entries.len();
        let mut pivot = rows[k].diagonal * (1.0 + regularization);
        for (number, word) in pattern[..=k / 64].iter_mut().enumerate().skip(lowest / 64) {
            let mut columns = std::mem::take(word);
            while columns != 0 {
                let column = 64 * number + columns.trailing_zeros() as usize;
                columns &= columns - 1;
                let node = &nodes[column];
                let mut work = node.work;
                for entry in &entries[node.begin as usize..node.end as usize] {
                    work -= entry.value * nodes[entry.column as usize].work;
                }
                let node = &mut nodes[column];
                node.work = work;
                let value = work * node.inverse_pivot;
                pivot -= work * value;
                entries.push(Entry {
                    column: column as u32,
                    value,
                });
                if node.parent > k as u32 {
                    // A row that had this column's first entry so far has one row more before it.
                    let parent = std::mem::replace(&mut node.parent, k as u32);
                    mark_dirty(nodes, parent);
                }
            }
        }
        for entry in &entries[begin..] {
            nodes[entry.column as usize].work = 0.0;
        }
        self.len += entries.len() - begin + 1;
        let node = &mut nodes[k];
        (node.begin, node.end) = (begin as u32, entries.len() as u32);
        // Rounding may eat a pivot that only regularization keeps positive.
        node.inverse_pivot = 1.0 / pivot.max(0.5 * regularization * rows[k].diagonal);
    }

    /// Marks in `pattern` where row k has entries, and puts its couplings to `work`; returns the lowest
    /// column.
    fn find_pattern(&mut self, rows: &[Row], k: usize) -> usize {
        let (nodes, pattern) = (self.nodes.as_mut_slice(), self.pattern.as_mut_slice());
        let row = &rows[k];
        let mut lowest = k;
        for side in 0..2 {
            let mut link = row.before[side];
            while let Some(other) = rows.get(link as usize / 2) {
                let (place, other_side) = (link as usize / 2, link as usize % 2);
                link = other.before[other_side];
                if !other.is_active {
                    continue;
                }
                nodes[place].work += row.coupling(side, other, other_side);
                lowest = lowest.min(place);
                // The row and its ancestors before row k.
                let mut column = place;
                while column < k {
                    let (word, bit) = (&mut pattern[column / 64], 1 << (column % 64));
                    if *word & bit != 0 {
                        break;
                    }
                    *word |= bit;
                    column = nodes[column].parent as usize;
                }
            }
        }
        lowest
    }

    /// Solves A_FF·x = x in place, for active rows; others hold zeros.
    pub fn solve(&self, x: &mut [f64]) {
        for (k, node) in self.nodes.iter().enumerate() {
            if node.end > node.begin {
                let mut value = x[k];
                for entry in &self.entries[node.begin as usize..node.end as usize] {
                    value -= entry.value * x[entry.column as usize];
                }
                x[k] = value;
            }
        }
        for (value, node) in x.iter_mut().zip(&self.nodes) {
            *value *= node.inverse_pivot;
        }
        for (k, node) in self.nodes.iter().enumerate().rev() {
            if node.end > node.begin {
                let value = x[k];
                for entry in &self.entries[node.begin as usize..node.end as usize] {
                    x[entry.column as usize] -= entry.value * value;
                }
            }
        }
    }
}

/// A row changes, and with it its ancestors.
fn mark_dirty(nodes: &mut [Node], row: u32) {
    let mut row = row;
    while let Some(node) = nodes.get_mut(row as usize)
        && !node.is_dirty
    {
        node.is_dirty = true;
        row = node.parent;
    }
}
