//! Cholesky factor of the contact matrix over the active contacts of one island, stored row by row
//! from the first nonzero (envelope). Rows depend on earlier rows only, so a change of the active set
//! refactors from the first changed contact on.

use crate::contact::ContactProblem;

const NONE: u32 = u32::MAX;

/// The factor L of A_FF = L·Lᵀ for an ordered list F of contacts.
#[derive(Debug, Clone, Default)]
pub struct EnvelopeFactor {
    /// F.
    members: Vec<u32>,
    /// First column of each row.
    first: Vec<u32>,
    /// Where each row's diagonal lies in `values`.
    diagonal: Vec<usize>,
    values: Vec<f64>,
}

/// For each boat, a linked list of the factored contacts on it.
#[derive(Debug, Clone, Default)]
pub struct BoatLinks {
    head: Vec<u32>,
    /// (next link, row in the factor, whether the boat is the contact's second).
    links: Vec<(u32, u32, bool)>,
}

impl BoatLinks {
    /// Makes room for so many boats.
    pub fn reset(&mut self, boats: usize) {
        self.head.clear();
        self.head.resize(boats, NONE);
        self.links.clear();
    }

    fn push(&mut self, boat: usize, row: usize, is_second: bool) {
        self.links.push((self.head[boat], row as u32, is_second));
        self.head[boat] = self.links.len() as u32 - 1;
    }

    fn clear_boat(&mut self, boat: usize) {
        self.head[boat] = NONE;
    }

    fn rows(&self, boat: usize) -> impl Iterator<Item = (usize, bool)> + '_ {
        let mut link = self.head[boat];
        std::iter::from_fn(move || {
            let &(next, row, is_second) = self.links.get(link as usize)?;
            link = next;
            Some((row as usize, is_second))
        })
    }
}

impl EnvelopeFactor {
    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    /// How many numbers the factor holds.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    fn truncate(&mut self, rows: usize) {
        self.members.truncate(rows);
        self.first.truncate(rows);
        self.diagonal.truncate(rows);
        self.values
            .truncate(self.diagonal.last().map_or(0, |&last| last + 1));
    }

    /// Brings the factor to the contacts in `wanted`; returns how many rows were computed.
    /// `ridge` is added to the diagonal, relative to it.
    pub fn update(
        &mut self,
        problem: &ContactProblem,
        wanted: impl Iterator<Item = u32> + Clone,
        ridge: f64,
        links: &mut BoatLinks,
    ) -> u64 {
        let kept = wanted
            .clone()
            .zip(&self.members)
            .take_while(|(a, b)| a == *b)
            .count();
        if kept == self.members.len() && wanted.clone().nth(kept).is_none() {
            return 0;
        }
        self.truncate(kept);
        for row in 0..kept {
            self.link(problem, row, links);
        }
        let mut computed = 0;
        for contact in wanted.clone().skip(kept) {
            self.push_row(problem, contact, ridge, links);
            self.link(problem, self.members.len() - 1, links);
            computed += 1;
        }
        for &k in &self.members {
            let contact = &problem.contacts[k as usize];
            links.clear_boat(contact.boat as usize);
            if let Some(second) = contact.second() {
                links.clear_boat(second);
            }
        }
        links.links.clear();
        computed
    }

    fn link(&self, problem: &ContactProblem, row: usize, links: &mut BoatLinks) {
        let contact = &problem.contacts[self.members[row] as usize];
        links.push(contact.boat as usize, row, false);
        if let Some(second) = contact.second() {
            links.push(second, row, true);
        }
    }

    /// Appends the row of one more contact: its couplings through shared boats, then elimination.
    fn push_row(&mut self, problem: &ContactProblem, k: u32, ridge: f64, links: &BoatLinks) {
        let contact = &problem.contacts[k as usize];
        let row = self.members.len();
        let boats = [Some(contact.boat as usize), contact.second()];
        let first = boats
            .iter()
            .flatten()
            .flat_map(|&boat| links.rows(boat))
            .map(|(other, _)| other)
            .min()
            .unwrap_or(row);
        let begin = self.values.len();
        self.values.resize(begin + row - first + 1, 0.0);
        for (is_second, boat) in boats.into_iter().enumerate() {
            let Some(boat) = boat else { continue };
            let is_second = is_second == 1;
            let inertia = &problem.inertia[boat];
            let arm = if is_second {
                contact.gap.arm_j
            } else {
                contact.gap.arm_i
            };
            for (other, other_is_second) in links.rows(boat) {
                let gap = &problem.contacts[self.members[other] as usize].gap;
                let other_arm = if other_is_second {
                    gap.arm_j
                } else {
                    gap.arm_i
                };
                let coupling = contact.gap.normal.dot(&gap.normal) * inertia.linear
                    + arm * other_arm * inertia.angular;
                let sign = if is_second == other_is_second {
                    1.0
                } else {
                    -1.0
                };
                self.values[begin + other - first] += sign * coupling;
            }
        }
        let diagonal = problem.diagonal(k as usize) * (1.0 + ridge);
        self.members.push(k);
        self.first.push(first as u32);
        self.diagonal.push(begin + row - first);
        self.eliminate(row, diagonal, ridge);
    }

    fn eliminate(&mut self, row: usize, diagonal: f64, ridge: f64) {
        let first = self.first[row] as usize;
        let begin = self.diagonal[row] - (row - first);
        let (done, rest) = self.values.split_at_mut(begin);
        let current = &mut rest[..row - first];
        let mut squares = 0.0;
        for column in first..row {
            let column_first = self.first[column] as usize;
            let from = first.max(column_first);
            let pivot = self.diagonal[column];
            let column_row = &done[pivot - (column - from)..pivot];
            let sum = dot(column_row, &current[from - first..column - first]);
            let value = (current[column - first] - sum) / done[pivot];
            current[column - first] = value;
            squares += value * value;
        }
        // Rounding may eat a pivot that only the ridge keeps positive.
        let pivot = (diagonal - squares).max(0.5 * ridge * diagonal).sqrt();
        rest[row - first] = pivot;
    }

    /// Solves A_FF·x = x in place; `x` is ordered as the members.
    pub fn solve(&self, x: &mut [f64]) {
        for row in 0..x.len() {
            let (entries, first) = self.row(row);
            let sum = dot(entries, &x[first..row]);
            x[row] = (x[row] - sum) / self.values[self.diagonal[row]];
        }
        for row in (0..x.len()).rev() {
            let (entries, first) = self.row(row);
            let value = x[row] / self.values[self.diagonal[row]];
            x[row] = value;
            x[first..row]
                .iter_mut()
                .zip(entries)
                .for_each(|(x, entry)| *x -= entry * value);
        }
    }

    fn row(&self, row: usize) -> (&[f64], usize) {
        let first = self.first[row] as usize;
        let pivot = self.diagonal[row];
        (&self.values[pivot - (row - first)..pivot], first)
    }
}

/// Four running sums: the compiler may not reorder floating-point additions by itself.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a_chunks, b_chunks) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a_chunks
        .remainder()
        .iter()
        .zip(b_chunks.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in a_chunks.zip(b_chunks) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail
}
