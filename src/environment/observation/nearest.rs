//! The boats nearest to leaders. Processors mispredict branches that depend on distances, and a misprediction costs more
//! than the arithmetic for all boats. So loops over boats have no such branch, as long as few boats are wanted.

use crate::geometry::HullPose;
use wide::f64x4;

/// Leaders whose distances are computed together.
const AT_ONCE: usize = 4;
/// Up to this many boats are found and sorted without branches.
const FEW: usize = 16;
/// A leader's search has a limit: the squared distance of the farthest wanted boat in its last search, times this factor.
const GROWTH: f64 = 1.1;

/// Finds the nearest boats; remembers the limits of the last search.
#[derive(Debug, Clone, Default)]
pub(super) struct Nearest {
    /// Squared distances of every boat from the present [`AT_ONCE`] leaders; a leader's distance from itself is infinite.
    squares: Vec<[f64; AT_ONCE]>,
    /// For each leader, the squared distance within which its next search looks for boats.
    limits: Vec<f64>,
    /// Scratch memory: starts with the boats that the present search found.
    candidates: Vec<u32>,
}

impl Nearest {
    /// The `wanted` boats with the nearest centers to a leader, or all if there are fewer. They come nearest first,
    /// equally near boats in the order of their indices. Call this for leaders 0, 1, … in that order.
    pub(super) fn of_leader(
        &mut self,
        hulls: &[HullPose],
        leader: usize,
        wanted: usize,
    ) -> impl Iterator<Item = usize> {
        let lane = leader % AT_ONCE;
        if lane == 0 {
            self.measure(hulls, leader);
        }
        let mut count = self.find(leader);
        let has_too_few = count < wanted.min(hulls.len() - 1);
        let has_too_many_to_sort = wanted <= FEW && count > FEW;
        if has_too_few || has_too_many_to_sort {
            self.set_limits(leader - lane, wanted);
            count = self.find(leader);
        }
        let candidates = &mut self.candidates[..count];
        sort(candidates, |boat| self.squares[boat as usize][lane]);
        let last_wanted = candidates.get(wanted - 1);
        let square = last_wanted.map_or(f64::MAX, |&boat| self.squares[boat as usize][lane]);
        self.limits[leader] = (GROWTH * square).min(f64::MAX);
        self.candidates[..count.min(wanted)]
            .iter()
            .map(|&boat| boat as usize)
    }

    /// Lists the boats within a leader's limit in `candidates`; returns their number.
    fn find(&mut self, leader: usize) -> usize {
        let (lane, limit) = (leader % AT_ONCE, self.limits[leader]);
        let mut count = 0;
        for (boat, squares) in self.squares.iter().enumerate() {
            // Without a branch: a boat that is too far is overwritten by the next one.
            self.candidates[count] = boat as u32;
            count += usize::from(squares[lane] <= limit);
        }
        count
    }

    /// Computes squared distances of all boats from [`AT_ONCE`] boats, from `first` on: leaders, and perhaps others after
    /// the last leader.
    fn measure(&mut self, hulls: &[HullPose], first: usize) {
        let centers = hulls[first..].iter().map(|hull| hull.center);
        let (mut x, mut y) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
        for (lane, center) in centers.take(AT_ONCE).enumerate() {
            (x[lane], y[lane]) = (center.x, center.y);
        }
        let (x, y) = (f64x4::new(x), f64x4::new(y));
        // `find` may write one boat after the last candidate.
        self.candidates.resize(hulls.len() + 1, 0);
        self.limits.resize(hulls.len() + AT_ONCE, f64::MAX);
        self.squares.clear();
        self.squares.extend(hulls.iter().map(|hull| {
            let (dx, dy) = (hull.center.x - x, hull.center.y - y);
            (dx * dx + dy * dy).to_array()
        }));
        // A leader is not its own neighbor.
        for (lane, squares) in self.squares[first..].iter_mut().take(AT_ONCE).enumerate() {
            squares[lane] = f64::INFINITY;
        }
    }

    /// Sets the limits of the [`AT_ONCE`] leaders from `first` on so that each finds `wanted` boats: exactly, up to equal
    /// distances, if `wanted` is at most [`FEW`]; otherwise each finds all boats.
    fn set_limits(&mut self, first: usize, wanted: usize) {
        let limits = if wanted <= FEW {
            self.nth_smallest(wanted)
        } else {
            f64x4::splat(f64::INFINITY)
        };
        let limits = limits.fast_min(f64x4::splat(f64::MAX)).to_array();
        self.limits[first..first + AT_ONCE].copy_from_slice(&limits);
    }

    /// For each of the present [`AT_ONCE`] leaders, the `wanted`-th smallest squared distance; `wanted` is at most
    /// [`FEW`].
    fn nth_smallest(&self, wanted: usize) -> f64x4 {
        let mut smallest = [f64x4::splat(f64::INFINITY); FEW];
        let smallest = &mut smallest[..wanted];
        for &squares in &self.squares {
            let mut square = f64x4::new(squares);
            // The slots stay in ascending order: a displaced square moves to the next slot.
            for slot in &mut *smallest {
                (*slot, square) = (slot.fast_min(square), slot.fast_max(square));
            }
        }
        smallest[wanted - 1]
    }
}

/// Sorts boats by squared distance. They come in the order of their indices, and equally near boats stay in it.
fn sort(boats: &mut [u32], square: impl Fn(u32) -> f64) {
    if boats.len() > FEW {
        boats.sort_by(|&a, &b| square(a).total_cmp(&square(b)));
        return;
    }
    // A boat's rank, its index in the sorted order, starts as its present index and changes with each comparison.
    let (mut squares, mut ranks, mut sorted) = ([0.0; FEW], [0; FEW], [0; FEW]);
    for (k, &boat) in boats.iter().enumerate() {
        (squares[k], ranks[k]) = (square(boat), k);
        for earlier in 0..k {
            let is_nearer = usize::from(squares[k] < squares[earlier]);
            ranks[earlier] += is_nearer;
            ranks[k] -= is_nearer;
        }
    }
    for (&boat, rank) in boats.iter().zip(ranks) {
        sorted[rank] = boat;
    }
    boats.copy_from_slice(&sorted[..boats.len()]);
}
