//! The nearest boats of leaders. A processor cannot predict which boats are near, and a wrong prediction costs more
//! than the arithmetic for all boats. So no branch depends on distances.

use crate::geometry::HullPose;
use wide::f64x4;

/// Leaders whose distances are computed together.
const AT_ONCE: usize = 4;
/// Up to this many boats are found and sorted without branches.
const FEW: usize = 16;
/// Boats are looked for within the farthest distance of the leader's last search; its square is multiplied by this.
const GROWTH: f64 = 1.1;

/// Finds the nearest boats, with its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Nearest {
    /// Squared distances of every boat from the present leaders; a leader's distance from itself is infinite.
    squares: Vec<[f64; AT_ONCE]>,
    /// Squared distances within which each leader had the wanted number of boats in its last search; they may be
    /// slightly too large.
    limits: Vec<f64>,
    /// A leader's nearest boats, in front.
    found: Vec<u32>,
}

impl Nearest {
    /// The `wanted` nearest boats of a leader by center distance, or all if there are fewer: nearest first, equally
    /// near ones in the order of boats. Leaders come one after another.
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
        if count < wanted.min(hulls.len() - 1) || wanted <= FEW && count > FEW {
            self.set_limits(leader - lane, wanted);
            count = self.find(leader);
        }
        let found = &mut self.found[..count];
        sort(found, |boat| self.squares[boat as usize][lane]);
        let last = found.get(wanted - 1);
        let square = last.map_or(f64::MAX, |&boat| self.squares[boat as usize][lane]);
        self.limits[leader] = (GROWTH * square).min(f64::MAX);
        self.found[..count.min(wanted)]
            .iter()
            .map(|&boat| boat as usize)
    }

    /// Lists the boats within a leader's limit; returns their number.
    fn find(&mut self, leader: usize) -> usize {
        let (lane, limit) = (leader % AT_ONCE, self.limits[leader]);
        let mut count = 0;
        for (boat, squares) in self.squares.iter().enumerate() {
            self.found[count] = boat as u32;
            count += usize::from(squares[lane] <= limit);
        }
        count
    }

    /// Computes distances from up to [`AT_ONCE`] leaders, from `first` on.
    fn measure(&mut self, hulls: &[HullPose], first: usize) {
        let others = hulls[first..].iter().map(|hull| hull.center);
        let (mut x, mut y) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
        for (lane, center) in others.take(AT_ONCE).enumerate() {
            (x[lane], y[lane]) = (center.x, center.y);
        }
        let (x, y) = (f64x4::new(x), f64x4::new(y));
        self.found.resize(hulls.len() + 1, 0);
        self.limits.resize(hulls.len() + AT_ONCE, f64::MAX);
        self.squares.clear();
        self.squares.extend(hulls.iter().map(|hull| {
            let (dx, dy) = (hull.center.x - x, hull.center.y - y);
            (dx * dx + dy * dy).to_array()
        }));
        for (lane, own) in self.squares[first..].iter_mut().take(AT_ONCE).enumerate() {
            own[lane] = f64::INFINITY;
        }
    }

    /// Sets the limits of the present leaders from their distances.
    fn set_limits(&mut self, first: usize, wanted: usize) {
        let limits = if wanted <= FEW {
            self.largest_of_smallest(wanted)
        } else {
            f64x4::splat(f64::INFINITY)
        };
        let limits = limits.fast_min(f64x4::splat(f64::MAX)).to_array();
        self.limits[first..first + AT_ONCE].copy_from_slice(&limits);
    }

    /// The largest of the `wanted` smallest squares, at most [`FEW`], for each of the present leaders.
    fn largest_of_smallest(&self, wanted: usize) -> f64x4 {
        let mut smallest = [f64x4::splat(f64::INFINITY); FEW];
        let smallest = &mut smallest[..wanted];
        for &squares in &self.squares {
            let mut square = f64x4::new(squares);
            // Kept in ascending order: a displaced square moves to the next slot.
            for kept in &mut *smallest {
                (*kept, square) = (kept.fast_min(square), kept.fast_max(square));
            }
        }
        smallest[wanted - 1]
    }
}

/// Sorts boats, which come in their order, by distance.
fn sort(found: &mut [u32], square: impl Fn(u32) -> f64) {
    if found.len() > FEW {
        found.sort_by(|&a, &b| square(a).total_cmp(&square(b)));
        return;
    }
    let (mut squares, mut ranks, mut sorted) = ([0.0; FEW], [0; FEW], [0; FEW]);
    for (k, &boat) in found.iter().enumerate() {
        (squares[k], ranks[k]) = (square(boat), k);
        for earlier in 0..k {
            let is_nearer = usize::from(squares[k] < squares[earlier]);
            ranks[earlier] += is_nearer;
            ranks[k] -= is_nearer;
        }
    }
    for (&boat, rank) in found.iter().zip(ranks) {
        sorted[rank] = boat;
    }
    found.copy_from_slice(&sorted[..found.len()]);
}
