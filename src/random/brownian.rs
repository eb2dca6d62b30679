//! Brownian paths that can be read at any time, from keyed normal draws.
//!
//! The noise is keyed, not consumed: a draw is a function of (seed, boat, time). So two policies or two control rates
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

    /// N(0, 1) of each boat for (cell, node).
    #[inline]
    fn draws(&self, cell: u64, node: u64) -> impl Iterator<Item = f64> {
        let word = scramble(scramble(cell).wrapping_add(node));
        let words = self.keys.iter().map(move |key| key.wrapping_add(word));
        words.map(|word| self.ziggurat.normal(scramble(word)))
    }
}

/// Number of times that a cell is halved. Within the smallest parts, each time has its own draw.
const HALVINGS: u32 = 10;

/// A Brownian path per boat, readable at any time: the same path however the time axis is cut.
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
    /// Where the last increment ended: most increments start there.
    last: Reading,
    /// Scratch: the paths at both ends of an interval, one value per boat.
    low: Vec<f64>,
    high: Vec<f64>,
}

/// The paths at a point within a cell.
#[derive(Debug, Clone)]
struct Reading {
    /// The cell, and half ticks since its start; `None` before the first reading.
    point: Option<(u64, u64)>,
    /// Increments since the cell's start, one per boat.
    path: Vec<f64>,
    /// Increments over the whole cell, one per boat.
    whole: Vec<f64>,
}

/// Half a tick of 1 ns, in seconds.
const HALF_TICK_S: f64 = 0.5e-9;

impl BrownianPaths {
    /// Paths of a seed for `boats` boats. Cells are `cell_length` half ticks long, and the first starts `shift` half
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
            low: zeros.clone(),
            high: zeros,
        }
    }

    /// Changes to other paths in the same cells.
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
            let a = from.max(start) - start;
            let b = to.min(start + self.cell_length) - start;
            if a > 0 {
                self.read(cell, a);
                add(increments, -1.0, &self.last.path);
            }
            if b < self.cell_length {
                self.read(cell, b);
                add(increments, 1.0, &self.last.path);
            } else if a > 0 {
                add(increments, 1.0, &self.last.whole);
            } else {
                let scale = (self.cell_length as f64 * HALF_TICK_S).sqrt();
                let draws = self.normals.draws(cell, 0);
                increments
                    .iter_mut()
                    .zip(draws)
                    .for_each(|(sum, draw)| *sum += scale * draw);
            }
        }
    }

    /// Draws keyed by a time, for noise that is drawn step by step.
    pub(crate) fn step_draws(&mut self, time: u64, draws: &mut [f64]) {
        let normals = self.normals.draws(time, 0);
        draws
            .iter_mut()
            .zip(normals)
            .for_each(|(draw, normal)| *draw = normal);
    }

    /// Draws the increments over a whole cell.
    fn draw_whole(&mut self, cell: u64) {
        let scale = (self.cell_length as f64 * HALF_TICK_S).sqrt();
        let draws = self.normals.draws(cell, 0);
        let whole = self.last.whole.iter_mut().zip(draws);
        whole.for_each(|(whole, draw)| *whole = scale * draw);
    }

    /// Sets `last` to the paths at `offset` half ticks into a cell, strictly inside of it.
    fn read(&mut self, cell: u64, offset: u64) {
        let known = self.last.point.replace((cell, offset));
        if known == Some((cell, offset)) {
            return;
        }
        if known.is_none_or(|(known, _)| known != cell) {
            self.draw_whole(cell);
        }
        let Reading { path, whole, .. } = &mut self.last;
        let (low, high) = (&mut self.low, &mut self.high);
        low.fill(0.0);
        high.copy_from_slice(whole);
        let (mut start, mut end, mut node) = (0, self.cell_length, 1_u64);
        loop {
            // Keys of the bisection's nodes come first, then keys of times.
            let (middle, key) = if node < 1 << HALVINGS {
                (start + (end - start) / 2, node)
            } else {
                (offset, (1 << HALVINGS) + offset)
            };
            let (left, right) = ((middle - start) as f64, (end - middle) as f64);
            let (to_low, to_high) = (right / (left + right), left / (left + right));
            let spread = (left * to_low * HALF_TICK_S).sqrt();
            let ends = low.iter().zip(&*high).zip(self.normals.draws(cell, key));
            for (path, ((low, high), draw)) in path.iter_mut().zip(ends) {
                *path = low * to_low + high * to_high + spread * draw;
            }
            if middle == offset {
                return;
            }
            if offset > middle {
                (start, node) = (middle, 2 * node + 1);
                low.copy_from_slice(path);
            } else {
                (end, node) = (middle, 2 * node);
                high.copy_from_slice(path);
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
