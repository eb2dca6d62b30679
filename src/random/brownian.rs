//! Brownian paths that can be read at any time, from keyed normal draws.
//!
//! The noise stream is keyed, not consumed: a draw is a function of (seed, cell of time, boat), so two
//! policies or two control rates on one seed meet the same noise, and a snapshot needs to hold no
//! generator.

use super::streams::{Stream, StreamRng};
use rand::distr::Distribution;
use rand_chacha::rand_core::Rng;
use rand_distr::StandardNormal;

/// Standard normal draws keyed by (cell, node, boat).
#[derive(Debug, Clone)]
struct KeyedNormals {
    /// At its start.
    words: StreamRng,
    tail: StreamRng,
}

impl KeyedNormals {
    fn new(seed: u64) -> Self {
        Self {
            words: Stream::Noise.rng(seed),
            tail: Stream::NoiseTail.rng(seed),
        }
    }

    /// `draws[boat] = N(0, 1)` for (cell, node): one 64-bit word a boat, and a private stretch of
    /// the tail stream in the 1.2 % of draws where the ziggurat wants more.
    fn fill(&mut self, cell: u64, node: u32, draws: &mut [f64]) {
        // A generator that has handed out words fills its buffer again at every change of place: a fresh
        // copy, only once.
        let mut words = self.words.clone();
        words.set_stream(cell);
        if node > 0 {
            words.set_word_pos(u128::from(node) << 32);
        }
        for (boat, draw) in draws.iter_mut().enumerate() {
            let place = (u128::from(node) << 28 | boat as u128) << 8;
            let first = Some(words.next_u64());
            let mut source = OneWordThenTail {
                first,
                tail: &mut self.tail,
                cell,
                place,
            };
            *draw = StandardNormal.sample(&mut source);
        }
    }
}

/// Hands out one given word, then words from a tail stream that is positioned only if needed.
struct OneWordThenTail<'a> {
    first: Option<u64>,
    tail: &'a mut StreamRng,
    cell: u64,
    place: u128,
}

impl rand_chacha::rand_core::TryRng for OneWordThenTail<'_> {
    type Error = std::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        Ok(self.try_next_u64()? as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        if let Some(word) = self.first.take() {
            return Ok(word);
        }
        self.tail.set_stream(self.cell);
        self.tail.set_word_pos(self.place);
        self.place += 2;
        Ok(self.tail.next_u64())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.try_next_u64()?.to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

/// A Brownian path per boat, readable at any time: the same path however the time axis is cut.
///
/// Time is counted in half ticks. The axis is divided in cells of one full substep; the increment
/// over a whole cell is one draw, and increments over a part of a cell follow from a Brownian bridge
/// that is refined by bisection down to the requested time.
#[derive(Debug, Clone)]
pub struct BrownianPaths {
    normals: KeyedNormals,
    /// Length of a cell in half ticks.
    cell_length: u64,
    /// Cell j covers [j·length − shift, (j + 1)·length − shift).
    shift: u64,
    /// Scratch: draws of a cell or node, one per boat.
    draws: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

/// Half a tick of 1 ns, in seconds.
const HALF_TICK_S: f64 = 0.5e-9;

impl BrownianPaths {
    /// Paths for `boats` boats; cells of `cell_length` half ticks, the first of them start
    /// `shift` half ticks before time 0.
    pub fn new(seed: u64, boats: usize, cell_length: u64, shift: u64) -> Self {
        let zeros = vec![0.0; boats];
        Self {
            normals: KeyedNormals::new(seed),
            cell_length,
            shift,
            draws: zeros.clone(),
            low: zeros.clone(),
            high: zeros,
        }
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
            self.add_path_value(cell, b, 1.0, increments);
            self.add_path_value(cell, a, -1.0, increments);
        }
    }

    /// Draws keyed by a time, for noise that is defined a step at a time.
    pub(crate) fn step_draws(&mut self, time: u64, draws: &mut [f64]) {
        self.normals.fill(time, 0, draws);
    }

    /// Adds `sign` times the path's value at `offset` half ticks into a cell, 0 at its start.
    fn add_path_value(&mut self, cell: u64, offset: u64, sign: f64, sums: &mut [f64]) {
        if offset == 0 {
            return;
        }
        let (mut start, mut end, mut node) = (0_u64, self.cell_length, 1_u32);
        let scale = (end as f64 * HALF_TICK_S).sqrt();
        self.normals.fill(cell, 0, &mut self.high);
        if offset == end {
            sums.iter_mut()
                .zip(&self.high)
                .for_each(|(sum, draw)| *sum += sign * scale * draw);
            return;
        }
        self.high.iter_mut().for_each(|value| *value *= scale);
        self.low.fill(0.0);
        loop {
            let middle = start + (end - start) / 2;
            self.normals.fill(cell, node, &mut self.draws);
            let (left, right) = ((middle - start) as f64, (end - middle) as f64);
            let spread = (left * right / (left + right) * HALF_TICK_S).sqrt();
            for ((draw, low), high) in self.draws.iter_mut().zip(&self.low).zip(&self.high) {
                *draw = (low * right + high * left) / (left + right) + spread * *draw;
            }
            if middle == offset {
                break;
            }
            let beyond = offset > middle;
            if beyond {
                (start, node) = (middle, 2 * node + 1);
                std::mem::swap(&mut self.low, &mut self.draws);
            } else {
                (end, node) = (middle, 2 * node);
                std::mem::swap(&mut self.high, &mut self.draws);
            }
        }
        sums.iter_mut()
            .zip(&self.draws)
            .for_each(|(sum, value)| *sum += sign * value);
    }
}
