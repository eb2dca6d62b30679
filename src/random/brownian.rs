//! Brownian paths that can be read at any time, from keyed normal draws.
//!
//! A draw is a function of (seed, boat, time), not the next number of a generator. So two policies or two control rates
//! get the same noise if the seed is the same, and a snapshot holds no generator.

use super::normal::{Ziggurat, scramble};
use super::streams::{Stream, StreamRng};
use rand_chacha::rand_core::Rng;

/// Standard normal draws keyed by (boat, cell, node).
#[derive(Debug, Clone)]
struct KeyedNormals {
    /// One key per boat.
    keys: Vec<u64>,
    ziggurat: Ziggurat,
}

impl KeyedNormals {
    fn new(mut generator: StreamRng, boats: usize) -> Self {
        Self {
            keys: (0..boats).map(|_| generator.next_u64()).collect(),
            ziggurat: Ziggurat::new(),
        }
    }

    /// A standard normal draw for each boat, keyed by (cell, node).
    #[inline]
    fn draws(&self, cell: u64, node: u64) -> impl Iterator<Item = f64> {
        let node_key = scramble(scramble(cell).wrapping_add(node));
        let words = self.keys.iter().map(move |key| key.wrapping_add(node_key));
        words.map(|word| self.ziggurat.normal(scramble(word)))
    }
}

/// Number of times that a cell is halved. In the smallest parts, the leaves, each time has its own draw.
const HALVINGS: u32 = 10;

/// A Brownian path per boat. A path can be read at any time, and does not depend on when it was read before.
///
/// Time is counted in half ticks. The axis is divided in cells of one full substep; the increment
/// over a whole cell is one draw. Within a cell the path follows from Brownian bridges: bisection down to leaves of
/// 1/1024 of the cell, then one bridge across the leaf, with a draw keyed by the time.
///
/// The path is a function of time, so increments over parts add up to the whole. Increments have the exact joint law of
/// Brownian motion as long as no two of their ends lie in the same leaf. The bridges of two such ends are independent,
/// so the variance of the increment between them is too large, by at most half a leaf's length.
#[derive(Debug, Clone)]
pub struct BrownianPaths {
    normals: KeyedNormals,
    /// Length of a cell in half ticks.
    cell_length: u64,
    /// Cell j covers [j·length − shift, (j + 1)·length − shift).
    shift: u64,
    /// The paths where the last increment ended, since most increments start there.
    last: Reading,
    /// Scratch memory: the paths at the start and the end of a bridge, one value per boat.
    path_at_start: Vec<f64>,
    path_at_end: Vec<f64>,
}

/// The paths at a point within a cell.
#[derive(Debug, Clone)]
struct Reading {
    /// The cell, and half ticks since its start; `None` before the first reading.
    point: Option<(u64, u64)>,
    /// Increments from the cell's start to the point, one per boat.
    path: Vec<f64>,
    /// Increments over the whole cell, one per boat.
    whole: Vec<f64>,
}

/// Half a tick of 1 ns, in seconds.
const HALF_TICK_S: f64 = 0.5e-9;

impl BrownianPaths {
    /// The paths of `boats` boats for a seed. Cells are `cell_length` half ticks long, and the first starts `shift` half
    /// ticks before time 0.
    pub fn new(seed: u64, boats: usize, cell_length: u64, shift: u64) -> Self {
        Self::from_keys(Stream::NOISE.rng(seed), boats, cell_length, shift)
    }

    /// As [`Self::new`], with keys from another stream.
    pub(crate) fn from_keys(keys: StreamRng, boats: usize, cell_length: u64, shift: u64) -> Self {
        let zeros = vec![0.0; boats];
        Self {
            normals: KeyedNormals::new(keys, boats),
            cell_length,
            shift,
            last: Reading {
                point: None,
                path: zeros.clone(),
                whole: zeros.clone(),
            },
            path_at_start: zeros.clone(),
            path_at_end: zeros,
        }
    }

    /// Replaces the paths by those of other keys, with the same cells.
    pub(crate) fn replace_keys(&mut self, keys: StreamRng) {
        let boats = self.normals.keys.len();
        *self = Self::from_keys(keys, boats, self.cell_length, self.shift);
    }

    /// `increments[boat] = W(to) − W(from)`, times in half ticks, in units of sqrt(s).
    pub fn increments(&mut self, from: u64, to: u64, increments: &mut [f64]) {
        let (from, to) = (from + self.shift, to + self.shift);
        let (first, last) = (from / self.cell_length, (to - 1) / self.cell_length);
        increments.fill(0.0);
        for cell in first..=last {
            let start = cell * self.cell_length;
            let from_offset = from.max(start) - start;
            let to_offset = to.min(start + self.cell_length) - start;
            if from_offset > 0 {
                self.read(cell, from_offset);
                add(increments, -1.0, &self.last.path);
            }
            if to_offset < self.cell_length {
                self.read(cell, to_offset);
                add(increments, 1.0, &self.last.path);
            } else if from_offset > 0 {
                add(increments, 1.0, &self.last.whole);
            } else {
                self.add_whole(cell, increments);
            }
        }
    }

    /// Writes standard normal draws keyed by a time, one per boat, for noise that is drawn step by step.
    pub(crate) fn step_draws(&mut self, time: u64, draws: &mut [f64]) {
        let normals = self.normals.draws(time, 0);
        draws
            .iter_mut()
            .zip(normals)
            .for_each(|(draw, normal)| *draw = normal);
    }

    /// Adds the increments over a whole cell, without a reading.
    fn add_whole(&self, cell: u64, increments: &mut [f64]) {
        let scale = (self.cell_length as f64 * HALF_TICK_S).sqrt();
        let draws = self.normals.draws(cell, 0);
        let sums = increments.iter_mut().zip(draws);
        sums.for_each(|(sum, draw)| *sum += scale * draw);
    }

    /// Sets `last.whole` to the increments over a whole cell.
    fn draw_whole(&mut self, cell: u64) {
        let scale = (self.cell_length as f64 * HALF_TICK_S).sqrt();
        let draws = self.normals.draws(cell, 0);
        let whole = self.last.whole.iter_mut().zip(draws);
        whole.for_each(|(whole, draw)| *whole = scale * draw);
    }

    /// Sets `last` to the paths at `offset` half ticks after a cell's start; the offset lies strictly inside the cell.
    fn read(&mut self, cell: u64, offset: u64) {
        let previous = self.last.point.replace((cell, offset));
        if previous == Some((cell, offset)) {
            return;
        }
        if previous.is_none_or(|(previous_cell, _)| previous_cell != cell) {
            self.draw_whole(cell);
        }
        let Reading { path, whole, .. } = &mut self.last;
        let (at_start, at_end) = (&mut self.path_at_start, &mut self.path_at_end);
        at_start.fill(0.0);
        at_end.copy_from_slice(whole);
        let (mut start, mut end, mut node) = (0, self.cell_length, 1_u64);
        loop {
            // Nodes of the bisection have the numbers of a binary heap; larger keys belong to times within leaves.
            let (point, key) = if node < 1 << HALVINGS {
                (start + (end - start) / 2, node)
            } else {
                (offset, (1 << HALVINGS) + offset)
            };
            let (left, right) = ((point - start) as f64, (end - point) as f64);
            let (start_weight, end_weight) = (right / (left + right), left / (left + right));
            let deviation = (left * start_weight * HALF_TICK_S).sqrt();
            let draws = self.normals.draws(cell, key);
            let ends = at_start.iter().zip(&*at_end).zip(draws);
            for (path, ((at_start, at_end), draw)) in path.iter_mut().zip(ends) {
                *path = at_start * start_weight + at_end * end_weight + deviation * draw;
            }
            if point == offset {
                return;
            }
            if offset > point {
                (start, node) = (point, 2 * node + 1);
                at_start.copy_from_slice(path);
            } else {
                (end, node) = (point, 2 * node);
                at_end.copy_from_slice(path);
            }
        }
    }
}

/// Adds `sign` times each value to `sums`.
fn add(sums: &mut [f64], sign: f64, values: &[f64]) {
    sums.iter_mut()
        .zip(values)
        .for_each(|(sum, value)| *sum += sign * value);
}
