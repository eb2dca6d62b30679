//! Every number that can be observed: names, units, scales and bounds as data. The observer applies
//! this table, and the documentation prints it.

use crate::geometry::Hull;
use crate::parameters::{FlockParameters, Value, named_fields};

/// The physical value of an observed 1.0; for the radius also the physical value of 0.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "`description` says what each is")]
pub enum Scale {
    Plain,
    Radial,
    Length,
    Speed,
    AngularVelocity,
    TimeLeft,
    Second,
}

impl Scale {
    /// The scale in words. The bounds are the centers of boats that touch the walls. Without an inner wall -1 is the
    /// pool's center, and in open water +1 is 40 boat radii farther than -1. The speed is the faster of the two
    /// preferred ones.
    pub fn description(self) -> &'static str {
        match self {
            Self::Plain => "1",
            Self::Radial => "-1 at the inner, +1 at the outer wall",
            Self::Length => "6 boat radii",
            Self::Speed => "preferred speed",
            Self::AngularVelocity => "2 rad/s",
            Self::TimeLeft => "2 s",
            Self::Second => "1 s",
        }
    }

    /// (gain, offset) with observed = gain·physical + offset.
    pub(super) fn affine(self, parameters: &FlockParameters) -> (f64, f64) {
        match self {
            Self::Plain | Self::Second => (1.0, 0.0),
            Self::Radial => radial(parameters),
            Self::Length => (1.0 / (6.0 * parameters.boat_radius_cm), 0.0),
            Self::Speed => (1.0 / speed_scale_cm_s(parameters), 0.0),
            Self::AngularVelocity => (1.0 / ANGULAR_VELOCITY_SCALE, 0.0),
            Self::TimeLeft => (0.5, 0.0),
        }
    }
}

/// Scale of angular velocities in rad/s.
pub(crate) const ANGULAR_VELOCITY_SCALE: f64 = 2.0;

/// The speed by which velocities are divided: the fastest preferred speed of any boat, not counting the spread; 15 cm/s
/// if all are 0.
pub(crate) fn speed_scale_cm_s(parameters: &FlockParameters) -> f64 {
    let fastest = parameters.speed_cm_s.max(parameters.reverse_speed_cm_s)
        * parameters.leader_speed_factor.max(1.0);
    if fastest > 0.0 { fastest } else { 15.0 }
}

/// Gain and offset of a distance from the pool's center: -1 at the inner wall and +1 at the outer one, as
/// [`Scale::description`] says.
fn radial(parameters: &FlockParameters) -> (f64, f64) {
    let (pool, radius) = (parameters.pool, Hull::new(parameters).radius);
    let inner = if pool.has_inner_wall() {
        pool.inner_radius_cm + radius
    } else {
        0.0
    };
    let outer = if pool.has_outer_wall() {
        pool.outer_radius_cm - radius
    } else {
        inner + 40.0 * radius
    };
    let half = (0.5 * (outer - inner)).max(f64::MIN_POSITIVE.sqrt());
    (1.0 / half, -0.5 * (outer + inner) / half)
}

/// One number of an observation or of the global state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Its name. All neighbors have entries of the same names; so do all boats of the global state.
    pub name: &'static str,
    /// Unit of the physical value.
    pub unit: &'static str,
    /// Meaning, with its sign.
    pub meaning: &'static str,
    /// Scaling of the physical value to the observed one.
    pub scale: Scale,
    /// Lower bound of the observed value.
    pub low: f64,
    /// Upper bound of the observed value.
    pub high: f64,
    /// Whether `mirror_to_target` changes its sign.
    pub mirrored: bool,
}

impl Entry {
    pub(super) const fn new(
        name: &'static str,
        unit: &'static str,
        scale: Scale,
        bounds: (f64, f64),
        meaning: &'static str,
    ) -> Self {
        let (low, high) = bounds;
        Self {
            name,
            unit,
            meaning,
            scale,
            low,
            high,
            mirrored: false,
        }
    }

    /// The fields of the entry by name, with its block and its index there.
    pub fn named(&self, block: &'static str, index: usize) -> Value {
        let [name, unit, low, high, mirrored, meaning] =
            named_fields!(self; name unit low high mirrored meaning);
        let scale = ("scale", self.scale.description().into());
        let at = [("block", block.into()), ("place", index.into())];
        let of_entry = [name, unit, scale, low, high, mirrored, meaning];
        at.into_iter().chain(of_entry).collect()
    }

    pub(super) const fn odd(self) -> Self {
        Self {
            mirrored: true,
            ..self
        }
    }
}

pub(super) const UNIT: (f64, f64) = (-1.0, 1.0);
pub(super) const FLAG: (f64, f64) = (0.0, 1.0);
pub(super) const TWICE: (f64, f64) = (-2.0, 2.0);

/// One boat of the global state.
#[rustfmt::skip]
pub const BOAT: [Entry; 10] = [
    Entry::new("radial_position", "cm", Scale::Radial, (-1.1, 1.1), "distance from the pool's center"),
    Entry::new("cos_polar_angle", "", Scale::Plain, UNIT, "cosine of its polar angle, counter-clockwise from x"),
    Entry::new("sin_polar_angle", "", Scale::Plain, UNIT, "its sine").odd(),
    Entry::new("cos_orientation", "", Scale::Plain, UNIT, "cosine of the LAP orientation"),
    Entry::new("sin_orientation", "", Scale::Plain, UNIT, "its sine: 1 heads clockwise").odd(),
    Entry::new("outward_velocity", "cm/s", Scale::Speed, TWICE, "velocity away from the pool's center"),
    Entry::new("clockwise_velocity", "cm/s", Scale::Speed, TWICE, "tangential velocity, positive clockwise").odd(),
    Entry::new("clockwise_spin", "rad/s", Scale::AngularVelocity, TWICE, "angular velocity, positive clockwise").odd(),
    Entry::new("rudder", "", Scale::Plain, UNIT, "a leader's rudder as it stands; 0 for a normal boat").odd(),
    Entry::new("is_leader", "", Scale::Plain, FLAG, "1 for a leader"),
];

/// Entries of the global state other than boats, phase and target.
#[rustfmt::skip]
pub(super) const CLOCK: [Entry; 1] =
    [Entry::new("episode_elapsed", "", Scale::Plain, FLAG, "part of the episode that is over")];
