//! The collective states of Table 2 and the ordering time of eq. (7), both from order parameters.

use super::OrderParameters;
use crate::parameters::named_choice;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

named_choice! {
    /// Collective state of a flock at one time (Table 2; ordered motion by its direction).
    pub enum CollectiveState ("state") {
        /// Boats point at the outer wall together and stand still.
        Jamming = "jamming",
        /// Most boats stick together in one cluster without a common direction, for a moment.
        Clustering = "clustering",
        /// Boats move clockwise together.
        OrderedClockwise = "ordered cw",
        /// Boats move counter-clockwise together.
        OrderedCounterClockwise = "ordered ccw",
        /// Boats have no common direction.
        Disordered = "disordered",
        /// Any other: between two of the states above, or without boats.
        Between = "between",
    }
}

/// Ψ_o above this is high: the level of eq. (7).
pub(crate) const HIGH_ORDER: f64 = 0.8;
/// Ψ_o below this is low: about halfway between an ordered and a disordered flock of 27 boats.
pub(crate) const LOW_ORDER: f64 = 0.5;
/// Mean velocities above this fraction of the preferred forward speed count as collective motion. In the analysis
/// window a boat that started from rest moves at 0.5 to 0.9 of that speed, a jammed one below 0.1.
pub(crate) const MOVING: f64 = 0.25;
/// Fraction of the boats that a cluster must hold to count as the whole flock.
pub(crate) const CLUSTERED: f64 = 0.75;

impl CollectiveState {
    /// The state of a flock in the analysis window from its order parameters, its boats' preferred forward speed and
    /// the fraction of boats in its largest cluster.
    pub fn from_order(order: &OrderParameters, speed_cm_s: f64, largest_cluster: f64) -> Self {
        let is_moving = order.psi_v >= MOVING * speed_cm_s;
        if order.psi_o > HIGH_ORDER {
            let is_tangential = off_tangent(order.phi_o) < FRAC_PI_4;
            return match (is_tangential, is_moving) {
                (true, true) if order.phi_o > 0.0 => Self::OrderedClockwise,
                (true, true) => Self::OrderedCounterClockwise,
                (false, false) if order.phi_o.abs() <= FRAC_PI_4 => Self::Jamming,
                _ => Self::Between,
            };
        }
        // Ψ_o is NaN at a time without boats.
        if order.psi_o >= LOW_ORDER || order.psi_o.is_nan() {
            return Self::Between;
        }
        if largest_cluster >= CLUSTERED {
            Self::Clustering
        } else {
            Self::Disordered
        }
    }
}

/// ||φ| − π/2|: the angle in rad between an orientation and the tangent.
pub fn off_tangent(phi: f64) -> f64 {
    (phi.abs() - FRAC_PI_2).abs()
}

/// Finds the ordering time τ of eq. (7), sample by sample.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct OrderingWatch {
    /// Number of samples in the second half of the run.
    late_samples: u32,
    /// Sum of Ψ_o over these samples.
    late_order: f64,
    /// The first time at which the flock was ordered.
    first_s: Option<f64>,
}

impl OrderingWatch {
    /// Records the order at a time in s since the run started. `within` is the angle in rad off the tangent below which an
    /// orientation counts as tangential. `is_late`: the time is in the second half of the run.
    pub(crate) fn note(
        &mut self,
        time_s: f64,
        order: &OrderParameters,
        within: f64,
        is_late: bool,
    ) {
        if is_late {
            self.late_samples += 1;
            self.late_order += order.psi_o;
        }
        let is_ordered = order.psi_o > HIGH_ORDER && off_tangent(order.phi_o) < within;
        if is_ordered && self.first_s.is_none() {
            self.first_s = Some(time_s);
        }
    }

    /// The first time in s at which Ψ_o > 0.8 and ||φ_o| − π/2| < `within`. It is infinite unless the mean Ψ_o over the
    /// second half of the run exceeds 0.8.
    pub fn ordering_time_s(&self) -> f64 {
        let stays = self.late_order > HIGH_ORDER * f64::from(self.late_samples);
        self.first_s.filter(|_| stays).unwrap_or(f64::INFINITY)
    }
}

/// Ordering time τ (eq. 7) of a run in s, infinite if the run does not order. The slices have equal length. Times increase
/// from the start of the run, at any time, to its end. Samples without boats, whose Ψ_o is NaN, are left out.
pub fn ordering_time(time_s: &[f64], order: &[OrderParameters], within: f64) -> f64 {
    let ends = time_s.first().zip(time_s.last());
    let half = ends.map_or(0.0, |(first, last)| (first + last) / 2.0);
    let mut watch = OrderingWatch::default();
    let samples = time_s.iter().zip(order);
    for (&time, order) in samples.filter(|(_, order)| !order.psi_o.is_nan()) {
        watch.note(time, order, within, time >= half);
    }
    watch.ordering_time_s()
}
