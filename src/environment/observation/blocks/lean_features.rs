//! Features from which a leader's lean is computed: numbers that the leader sees, mirrored so that the target is
//! clockwise, and standardized.

use super::super::entry::{Entry, Scale};
use super::super::view::{FlockView, Scaling};
use super::neighbors::{NEIGHBOR, Neighbors};
use super::order::{ORDER, Order};
use super::own::{OWN, Own};
use super::phase::{PHASE, Phase};
use super::{FromParameters, LeaderView, WriteBlock};
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;

/// Number of features.
pub const LEAN_FEATURES: usize = 29;

/// The pools in which the features are standardized.
const POOLS: [&str; 2] = ["wide", "narrow"];

/// Standardized features are clipped at ± this number. Larger ones occur only in flocks unlike those that were measured.
const BOUND: f64 = 20.0;

/// One row per feature: its mean and standard deviation in each of [`POOLS`], measured after 20 s in flocks of 27 boats
/// at the pool's critical noise, three of which the tuned law steers. Deviations are at least 0.05.
const MEANS_AND_DEVIATIONS: &str = include_str!("lean_features.csv");

/// The features as entries of an observation. They are the same for both targets, so that mirroring changes none.
#[rustfmt::skip]
pub(super) const ENTRIES: [Entry; LEAN_FEATURES] = [
    feature("radial_position", "distance from the pool's center, -1 at the inner and 1 at the outer wall"),
    feature("outward_velocity", "velocity away from the center over the preferred speed"),
    feature("clockwise_velocity", "velocity towards the target over the preferred speed"),
    feature("forward_velocity", "velocity along the heading over the preferred speed"),
    feature("near_outer_wall", "how much the radial position exceeds 0.6"),
    feature("mean_cos_orientation", "mean orientation of the normal boats, outward part"),
    feature("mean_sin_orientation", "the same, towards the target: the signed order"),
    feature("mean_outward_velocity", "mean velocity of the normal boats over the preferred speed, outward part"),
    feature("mean_clockwise_velocity", "the same, towards the target"),
    feature("near", "sum over the normal boats among the six nearest of w = exp(-d^2/2), d their distance over 6 boat radii"),
    feature("near_outward", "the same of w times the outward part of d"),
    feature("near_ahead", "the same of w times the part of d towards the target"),
    feature("near_opposed", "the same of w times o = (1 - cos)/2 of the angle between the headings"),
    feature("near_turned", "the same of w times t = the sine of that angle, positive towards the target"),
    feature("near_outward_velocity", "the same of w times the outward velocity over the preferred speed"),
    feature("near_clockwise_velocity", "the same of w times the velocity towards the target over the preferred speed"),
    feature("opposed_outward", "the same of w times o times the outward part of d"),
    feature("opposed_ahead", "the same of w times o times the part of d towards the target"),
    feature("turned_outward", "the same of w times t times the outward part of d"),
    feature("turned_ahead", "the same of w times t times the part of d towards the target"),
    feature("leaders", "sum over the leaders among the six nearest of exp(-d^2/8)"),
    feature("leaders_outward", "the same times the outward part of d"),
    feature("leaders_ahead", "the same times the part of d towards the target"),
    feature("cos_orientation", "cosine of the leader's LAP orientation"),
    feature("sin_orientation", "its sine, positive towards the target"),
    feature("clockwise_spin", "angular velocity over 2 rad/s, positive in the sense of the target's circulation"),
    feature("fw", "1 in the forward phase"),
    feature("bw", "1 in the backward phase"),
    feature("bw_duration", "length of the backward phase in s"),
];

const fn feature(name: &'static str, meaning: &'static str) -> Entry {
    Entry::new(name, "", Scale::Plain, (-BOUND, BOUND), meaning)
}

/// Mean and standard deviation of each feature in one of [`POOLS`], by its index.
fn means_and_deviations(pool: usize) -> [(f64, f64); LEAN_FEATURES] {
    let mut table = [(f64::NAN, f64::NAN); LEAN_FEATURES];
    for row in MEANS_AND_DEVIATIONS.lines().skip(1) {
        let mut cells = row.split(',');
        let name = cells.next();
        let index = ENTRIES.iter().position(|entry| Some(entry.name) == name);
        // After the name come a mean and a deviation for each pool.
        let mut numbers = cells.skip(2 * pool).map(str::parse);
        if let (Some(index), Some(Ok(mean)), Some(Ok(deviation))) =
            (index, numbers.next(), numbers.next())
        {
            table[index] = (mean, deviation);
        }
    }
    table
}

/// Number of neighbors that the features use.
const USED_NEIGHBORS: usize = 6;
/// Index of the first neighbor among the observed numbers, which are the blocks own, phase, neighbors and order.
const NEIGHBORS_START: usize = OWN.len() + PHASE.len();
/// Index of the first order parameter.
const ORDER_START: usize = NEIGHBORS_START + USED_NEIGHBORS * NEIGHBOR.len();
/// Number of observed numbers.
const OBSERVED: usize = ORDER_START + ORDER.len();

/// Writer of lean features.
#[derive(Debug, Clone)]
pub struct LeanFeatures {
    means_and_deviations: [(f64, f64); LEAN_FEATURES],
    scaling: Scaling,
    neighbors: Neighbors,
    order: Order,
    /// Scratch memory: the observed numbers before scaling.
    physical: Vec<f64>,
}

impl LeanFeatures {
    /// Names of the features, in order.
    pub fn names() -> impl Iterator<Item = &'static str> {
        ENTRIES.iter().map(|entry| entry.name)
    }

    /// A writer for checked parameters, with the means and deviations of a pool.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for pools in which the features are not standardized.
    pub fn standardized(parameters: &FlockParameters, pool: Option<&str>) -> Result<Self> {
        let index = Self::check_pool(pool)?;
        let neighbors = NEIGHBOR.iter().cycle();
        let neighbors = neighbors.take(USED_NEIGHBORS * NEIGHBOR.len());
        let entries = OWN.iter().chain(&PHASE).chain(neighbors).chain(&ORDER);
        Ok(Self {
            means_and_deviations: means_and_deviations(index),
            scaling: Scaling::new(entries.copied(), parameters),
            neighbors: Neighbors::default(),
            order: Order::default(),
            physical: Vec::with_capacity(OBSERVED),
        })
    }

    /// Checks that the features are standardized in a pool; returns its index in [`POOLS`].
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other pools, and without a name.
    pub(crate) fn check_pool(pool: Option<&str>) -> Result<usize> {
        let index = POOLS.iter().position(|name| Some(*name) == pool);
        index.ok_or_else(|| {
            let pools = POOLS.join(" and ");
            let accepted = format!("lean features are standardized only in the pools {pools}");
            FlockError::parameter("pool", pool.unwrap_or("without a name"), accepted)
        })
    }

    /// The features of a leader, rounded as in an observation. Call this for leaders 0, 1, … in that order.
    pub fn observed(&mut self, view: &FlockView, leader: usize) -> [f32; LEAN_FEATURES] {
        self.standardized_features(&LeaderView::new(view, leader))
            .map(|value| value.clamp(-BOUND, BOUND) as f32)
    }

    /// The standardized features, not yet clipped.
    fn standardized_features(&mut self, view: &LeaderView) -> [f64; LEAN_FEATURES] {
        let mut values = features(&self.observed_numbers(view));
        for (value, (mean, deviation)) in values.iter_mut().zip(self.means_and_deviations) {
            *value = (*value - mean) / deviation;
        }
        values
    }

    /// The blocks own, phase, neighbors and order as observed, mirrored so that the target is clockwise.
    fn observed_numbers(&mut self, view: &LeaderView) -> [f64; OBSERVED] {
        let physical = &mut self.physical;
        physical.clear();
        Own.write(view, 1, physical);
        Phase.write(view, 1, physical);
        self.neighbors.write(view, USED_NEIGHBORS, physical);
        self.order.write(view, 1, physical);
        let mut row = [0.0; OBSERVED];
        let is_mirrored = view.flock.targets.of(view.leader).sign() < 0.0;
        self.scaling.write(physical, is_mirrored, &mut row);
        row.map(f64::from)
    }
}

impl FromParameters for LeanFeatures {
    fn from_parameters(parameters: &FlockParameters) -> Result<Self> {
        Self::standardized(parameters, parameters.pool.name())
    }
}

impl WriteBlock for LeanFeatures {
    fn write(&mut self, view: &LeaderView, _repeats: usize, physical: &mut Vec<f64>) {
        physical.extend(self.standardized_features(view));
    }
}

/// The features in the order of [`ENTRIES`], before they are standardized: some of the observed numbers, and sums over
/// the neighbors that exist. Normal boats have the weight exp(-d²/2), leaders exp(-d²/8), where d is their distance in
/// units of 6 boat radii.
fn features(observed: &[f64; OBSERVED]) -> [f64; LEAN_FEATURES] {
    // The first entries of the block own, then three entries of the block phase.
    let &[radial, cos, sin, outward, clockwise, forward, spin, ..] = observed;
    let [fw, bw, bw_duration] = [0, 2, 5].map(|index| observed[OWN.len() + index]);
    let mut normal_sums = [0.0; 11];
    let mut leader_sums = [0.0; 3];
    for neighbor in observed[NEIGHBORS_START..ORDER_START].chunks_exact(NEIGHBOR.len()) {
        let &[present, x, y, cos_relative, turned, vx, vy, is_leader] = neighbor else {
            continue;
        };
        let square = x * x + y * y;
        if is_leader > 0.0 {
            let weight = present * libm::exp(-square / 8.0);
            add(&mut leader_sums, weight, [1.0, x, y]);
        } else {
            let weight = present * libm::exp(-square / 2.0);
            let opposed = (1.0 - cos_relative) / 2.0;
            let (ox, oy, tx, ty) = (opposed * x, opposed * y, turned * x, turned * y);
            let terms = [1.0, x, y, opposed, turned, vx, vy, ox, oy, tx, ty];
            add(&mut normal_sums, weight, terms);
        }
    }
    let near_outer_wall = (radial - 0.6).max(0.0);
    let mut features = [0.0; LEAN_FEATURES];
    features[..5].copy_from_slice(&[radial, outward, clockwise, forward, near_outer_wall]);
    features[5..9].copy_from_slice(&observed[ORDER_START..]);
    features[9..20].copy_from_slice(&normal_sums);
    features[20..23].copy_from_slice(&leader_sums);
    features[23..].copy_from_slice(&[cos, sin, spin, fw, bw, bw_duration]);
    features
}

/// Adds each term times the weight to its sum.
fn add<const N: usize>(sums: &mut [f64; N], weight: f64, terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}
