//! Cholesky factor of the contact matrix over the active contacts of one island, stored row by row
//! from the first nonzero (envelope). Rows depend on earlier rows only, so a change of the active set
//! refactors from the first changed contact on.

use super::matrix::ContactMatrix;

/// The factor L of A_FF = L·Lᵀ for an ordered list F of rows of the contact matrix.
#[derive(Debug, Clone, Default)]
pub struct EnvelopeFactor {
    /// F.
    members: Vec<u32>,
    /// First column of each row of L.
    first: Vec<u32>,
    /// Where each row of L ends in `values`.
    ends: Vec<u32>,
    /// Rows of L without their diagonals.
    values: Vec<f64>,
    /// One over the diagonal of L.
    inverse_diagonal: Vec<f64>,
}

/// Not in the active list.
pub const ABSENT: u32 = u32::MAX;

impl EnvelopeFactor {
    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    /// How many numbers the factor holds.
    pub fn len(&self) -> usize {
        self.values.len() + self.inverse_diagonal.len()
    }

    fn truncate(&mut self, rows: usize) {
        self.members.truncate(rows);
        self.first.truncate(rows);
        self.ends.truncate(rows);
        self.inverse_diagonal.truncate(rows);
        self.values
            .truncate(self.ends.last().map_or(0, |&end| end as usize));
    }

    /// Brings the factor to the rows in `wanted` (ascending); returns how many rows were computed.
    /// `regularization` is added to the diagonal, relative to it. `places` maps every row of the matrix to its
    /// place in the factor: scratch that holds only [`ABSENT`] before and after.
    pub fn update(
        &mut self,
        matrix: &ContactMatrix,
        wanted: &[u32],
        regularization: f64,
        places: &mut [u32],
    ) -> u64 {
        let kept = wanted
            .iter()
            .zip(&self.members)
            .take_while(|(a, b)| a == b)
            .count();
        self.truncate(kept);
        if kept == wanted.len() {
            return 0;
        }
        for (place, &row) in self.members.iter().enumerate() {
            places[row as usize] = place as u32;
        }
        for &row in &wanted[kept..] {
            self.push_row(matrix, row, regularization, places);
            places[row as usize] = self.members.len() as u32 - 1;
        }
        for &row in &self.members {
            places[row as usize] = ABSENT;
        }
        (wanted.len() - kept) as u64
    }

    /// Appends a row: its couplings to rows that are in the factor, then elimination.
    fn push_row(&mut self, matrix: &ContactMatrix, row: u32, regularization: f64, places: &[u32]) {
        let place = self.members.len();
        let couplings = matrix.couplings(row as usize);
        let present = couplings.iter().map(|&(other, _)| places[other as usize]);
        // ABSENT is larger than any place.
        let first = (present.min().unwrap_or(ABSENT) as usize).min(place);
        let begin = self.values.len();
        self.values.resize(begin + place - first, 0.0);
        for &(other, coupling) in couplings {
            let column = places[other as usize];
            if column != ABSENT {
                self.values[begin + column as usize - first] += coupling;
            }
        }
        self.members.push(row);
        self.first.push(first as u32);
        self.ends.push(self.values.len() as u32);
        let diagonal = matrix.rows()[row as usize].diagonal;
        self.eliminate(
            place,
            diagonal * (1.0 + regularization),
            0.5 * regularization * diagonal,
        );
    }

    fn eliminate(&mut self, place: usize, diagonal: f64, least: f64) {
        let first = self.first[place] as usize;
        let (done, current) = self
            .values
            .split_at_mut(self.ends[place] as usize - (place - first));
        let mut squares = 0.0;
        for column in first..place {
            let from = first.max(self.first[column] as usize);
            let end = self.ends[column] as usize;
            let sum = dot(
                &done[end - (column - from)..end],
                &current[from - first..column - first],
            );
            let value = (current[column - first] - sum) * self.inverse_diagonal[column];
            current[column - first] = value;
            squares += value * value;
        }
        // Rounding may eat a pivot that only the regularization keeps positive.
        self.inverse_diagonal
            .push(1.0 / (diagonal - squares).max(least).sqrt());
    }

    /// Solves A_FF·x = x in place; `x` is ordered as the members.
    pub fn solve(&self, x: &mut [f64]) {
        for place in 0..x.len() {
            let (entries, first) = self.row(place);
            x[place] = (x[place] - dot(entries, &x[first..place])) * self.inverse_diagonal[place];
        }
        for place in (0..x.len()).rev() {
            let (entries, first) = self.row(place);
            let value = x[place] * self.inverse_diagonal[place];
            x[place] = value;
            x[first..place]
                .iter_mut()
                .zip(entries)
                .for_each(|(x, entry)| *x -= entry * value);
        }
    }

    fn row(&self, place: usize) -> (&[f64], usize) {
        let (first, end) = (self.first[place] as usize, self.ends[place] as usize);
        (&self.values[end - (place - first)..end], first)
    }
}

/// Rows are short (a boat touches few others): a plain running sum beats unrolled lanes.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
