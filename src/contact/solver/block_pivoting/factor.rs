//! The sparse factor A_FF = L·D·Lᵀ of an island's active rows F, row by row.
//!
//! The elimination tree says where a row of L has entries (Liu 1990): at the rows with which it shares a boat, and at
//! their ancestors before it. The rows on one boat all share it, so they are ancestors of each other, and a row's
//! entries lie on the paths from the first row on either of its boats. A change of F changes only the rows that enter
//! or leave, and their ancestors.

use super::rows::{NONE, Row, Rows, WALLS};

/// Entries come in groups of this many, padded with zeros. Most rows have two or three entries; for these a loop of
/// unpredictable length costs more than the extra arithmetic.
const GROUP: usize = 2;

/// Rows of fewer entries cost too little to be counted.
const LONG_ROW: usize = 64;

/// An entry of L.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    column: u32,
    value: f64,
}

type Group = [Entry; GROUP];

/// A row of L.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Start and end of its entries among the groups.
    start: u32,
    end: u32,
    /// Number of its entries, without the zeros that fill up its groups.
    count: u32,
    /// Parent in the elimination tree: the first later row with an entry in this row's column.
    parent: u32,
    is_factored: bool,
    /// Whether the row has to be computed again.
    is_dirty: bool,
    /// For each of the row's two bodies, the previous active row on that body: twice that row's index, plus 1 if the body is
    /// that row's second one. [`NONE`] if there is no such row.
    previous: [u32; 2],
    inverse_pivot: f64,
}

const EMPTY: Node = Node {
    start: 0,
    end: 0,
    count: 0,
    parent: NONE,
    is_factored: false,
    is_dirty: false,
    previous: [NONE; 2],
    inverse_pivot: 0.0,
};

/// The active rows on a body that an update has visited so far.
#[derive(Debug, Clone, Copy)]
struct Chain {
    first: u32,
    /// As in [`Node::previous`].
    last: u32,
    /// Whether the last row has just entered the active set.
    has_entered: bool,
}

const NO_ROW: Chain = Chain {
    first: NONE,
    last: NONE,
    has_entered: false,
};

/// The factor of one island.
#[derive(Debug, Clone, Default)]
pub(super) struct Factor {
    nodes: Vec<Node>,
    groups: Vec<Group>,
    /// Number of groups in use.
    used: usize,
    /// Whether rows have entered or left the active set since the last update.
    is_stale: bool,
    /// Rough number of multiplications that are still allowed; negative if the update has stopped halfway.
    pub budget: i64,
    active: Vec<u32>,
    chains: Vec<Chain>,
    /// The row that is being computed; all zero between two computations. One more number at the end is always zero.
    work: Vec<f64>,
}

impl Factor {
    /// An empty factor for an island of a number of rows.
    pub(super) fn reset(&mut self, rows: usize) {
        self.nodes.clear();
        self.nodes.resize(rows, EMPTY);
        self.used = 0;
        self.is_stale = true;
        self.active.clear();
        self.work.resize(rows + 1, 0.0);
    }

    /// Number of entries in the factor of the active rows.
    pub(super) fn len(&self) -> u64 {
        let rows = self.active.iter().map(|&k| &self.nodes[k as usize]);
        rows.map(|node| u64::from(node.count) + 1).sum()
    }

    /// Marks the factor as outdated: rows have entered or left the active set.
    pub(super) fn set_stale(&mut self) {
        self.is_stale = true;
    }

    /// Computes the rows that have changed; returns how many. `regularization` is added to the diagonal, relative to
    /// it.
    pub(super) fn update(&mut self, rows: &Rows, regularization: f64) -> u64 {
        if !std::mem::take(&mut self.is_stale) {
            return 0;
        }
        self.active.clear();
        self.chains.clear();
        self.chains.resize(rows.bodies.len(), NO_ROW);
        let mut computed = 0;
        for (k, row) in rows.rows.iter().enumerate() {
            if row.is_active {
                if self.update_row(&rows.rows, k, regularization) {
                    computed += 1;
                    if self.budget < 0 {
                        break;
                    }
                }
            } else if self.nodes[k].is_factored {
                self.detach(k);
                self.nodes[k] = EMPTY;
            }
        }
        computed
    }

    /// Puts an active row into the chains of its bodies, and computes it if it has changed. Returns whether it has.
    fn update_row(&mut self, rows: &[Row], k: usize, regularization: f64) -> bool {
        let row = &rows[k];
        let [a, b] = row.bodies.map(|body| body as usize);
        let chains = [self.chains[a], self.chains[b]];
        let node = &mut self.nodes[k];
        node.previous = chains.map(|chain| chain.last);
        let has_entered = !node.is_factored;
        let is_dirty = has_entered | node.is_dirty | chains[0].has_entered | chains[1].has_entered;
        for (side, body) in [a, b].into_iter().enumerate() {
            self.chains[body] = Chain {
                first: chains[side].first.min(k as u32),
                last: (2 * k + side) as u32,
                has_entered,
            };
        }
        // Walls do not move, so the rows on them do not affect each other.
        self.chains[WALLS as usize] = NO_ROW;
        self.active.push(k as u32);
        if is_dirty {
            if !has_entered {
                self.detach(k);
            }
            self.compute(rows, k, chains.map(|chain| chain.first), regularization);
        }
        is_dirty
    }

    /// Removes a row from the elimination tree: its children lose their parent, and its own parent counts as changed.
    fn detach(&mut self, k: usize) {
        let node = self.nodes[k];
        for entry in row_of(&self.groups, &node).as_flattened() {
            if let Some(child) = self.nodes.get_mut(entry.column as usize)
                && child.parent == k as u32
            {
                child.parent = NONE;
            }
        }
        if let Some(parent) = self.nodes.get_mut(node.parent as usize) {
            parent.is_dirty = true;
        }
    }

    /// Computes row k, whose entries lie on the paths from `starts` up to it.
    fn compute(&mut self, rows: &[Row], k: usize, starts: [u32; 2], regularization: f64) {
        self.add_couplings(rows, k);
        let start = self.used;
        let most = start + k.div_ceil(GROUP) + 1;
        if self.groups.len() < most {
            self.groups.resize(2 * most, Group::default());
        }
        let nodes = self.nodes.as_mut_slice();
        let work = &mut self.work[..=nodes.len()];
        let (known, new) = self.groups.split_at_mut(start);
        let new = new.as_flattened_mut();
        let mut pivot = rows[k].diagonal * (1.0 + regularization);
        let [mut a, mut b] = starts;
        let mut count = 0;
        let row_index = k as u32;
        // Follows both paths at once, in the order of their columns.
        while a.min(b) < row_index {
            let column = a.min(b);
            let node = &mut nodes[column as usize];
            let parent = node.parent;
            let above = parent.min(row_index);
            node.parent = above;
            let remainder = work[column as usize] - dot(row_of(known, node), work);
            let value = remainder * node.inverse_pivot;
            work[column as usize] = remainder;
            pivot -= remainder * value;
            new[count] = Entry { column, value };
            count += 1;
            // Row k now has this column's first entry, so the row that had it changes, too. (NONE plus 1 is 0.)
            if parent.wrapping_add(1) > row_index + 1 {
                nodes[parent as usize].is_dirty = true;
            }
            a = if a == column { above } else { a };
            b = if b == column { above } else { b };
        }
        // Rounding may cancel a pivot that only regularization keeps positive.
        let least = 0.5 * regularization * rows[k].diagonal;
        nodes[k].inverse_pivot = 1.0 / if pivot > least { pivot } else { least };
        self.finish(k, count);
    }

    /// Pads the entries of a computed row with zeros, and clears `work`.
    fn finish(&mut self, k: usize, count: usize) {
        let start = self.used;
        if count > LONG_ROW {
            self.charge(start, count);
        }
        self.used = start + count.max(1).div_ceil(GROUP);
        let row = self.groups[start..].as_flattened_mut();
        row[count..count + GROUP].fill(Entry {
            column: self.nodes.len() as u32,
            value: 0.0,
        });
        for entry in self.groups[start..self.used].as_flattened() {
            self.work[entry.column as usize] = 0.0;
        }
        let node = &mut self.nodes[k];
        (node.start, node.end) = (start as u32, self.used as u32);
        node.count = count as u32;
        (node.is_factored, node.is_dirty) = (true, false);
    }

    /// Subtracts a long row's work from the budget: each of its entries was a product with another row.
    #[cold]
    fn charge(&mut self, start: usize, count: usize) {
        let entries = &self.groups[start..].as_flattened()[..count];
        let others = entries
            .iter()
            .map(|entry| &self.nodes[entry.column as usize]);
        self.budget -= others.map(|node| i64::from(node.count)).sum::<i64>();
    }

    /// Adds row k's couplings with the active rows before it to `work`.
    fn add_couplings(&mut self, rows: &[Row], k: usize) {
        // Slices of one length, so that one bounds check covers all three.
        let (nodes, work) = (&self.nodes[..rows.len()], &mut self.work[..rows.len()]);
        let row = &rows[k];
        for side in 0..2 {
            let mut link = nodes[k].previous[side];
            while link != NONE {
                let (index, other_side) = (link as usize / 2, link as usize % 2);
                work[index] += row.coupling(side, &rows[index], other_side);
                link = nodes[index].previous[other_side];
            }
        }
    }

    /// Solves A_FF·y = x for the active rows and stores y in x. Other rows of x must be zero. One more entry at the end
    /// of x is scratch space.
    pub(super) fn solve(&self, x: &mut [f64]) {
        // x is one longer than `nodes`, so that the bounds check of a row's node covers its entry of x.
        let nodes = self.nodes.as_slice();
        let x = &mut x[..=nodes.len()];
        x[nodes.len()] = 0.0;
        for &k in &self.active {
            let row = row_of(&self.groups, &nodes[k as usize]);
            x[k as usize] -= dot(row, x);
        }
        for (value, node) in x.iter_mut().zip(nodes) {
            *value *= node.inverse_pivot;
        }
        for &k in self.active.iter().rev() {
            let row = row_of(&self.groups, &nodes[k as usize]);
            let value = x[k as usize];
            for group in row {
                for entry in group {
                    x[entry.column as usize] -= entry.value * value;
                }
            }
        }
    }
}

#[inline]
fn row_of<'a>(groups: &'a [Group], node: &Node) -> &'a [Group] {
    &groups[node.start as usize..node.end as usize]
}

#[inline]
fn dot(row: &[Group], x: &[f64]) -> f64 {
    let term = |entry: &Entry| entry.value * x[entry.column as usize];
    let mut sum = 0.0;
    for [a, b] in row {
        sum += term(a) + term(b);
    }
    sum
}
