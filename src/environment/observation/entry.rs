//! Entries of observations: name, unit, scale and bounds of each observed number. The observer applies them, and the
//! documentation prints them.

use crate::geometry::Hull;
use crate::parameters::{FlockParameters, Value, named_fields};

/// The physical value that is observed as 1; for `Radial` also the physical value that is observed as 0.
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
    /// The scale in words.
    ///
    /// `Radial` is -1 for the center of a boat that touches the inner wall, and +1 at the outer wall. Without an inner
    /// wall, -1 is the pool's center; in open water, +1 is 40 boat radii farther out than -1. The preferred speed is the
    /// faster of forward and reverse.
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

/// The speed by which velocities are divided: the fastest preferred speed of leaders and normal boats, before
/// differences between boats are drawn; 15 cm/s if all preferred speeds are 0.
pub(crate) fn speed_scale_cm_s(parameters: &FlockParameters) -> f64 {
    let fastest = parameters.speed_cm_s.max(parameters.reverse_speed_cm_s)
        * parameters.leader_speed_factor.max(1.0);
    if fastest > 0.0 { fastest } else { 15.0 }
}

/// Gain and offset of distances from the pool's center, for the scale that [`Scale::description`] describes.
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
    // In a pool no wider than a boat, the lower limit avoids a division by 0.
    let half_width = (0.5 * (outer - inner)).max(f64::MIN_POSITIVE.sqrt());
    (1.0 / half_width, -0.5 * (outer + inner) / half_width)
}

/// One number of an observation or of the global state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Name of the number. The entries of all neighbors have the same names; so have those of all boats in the global
    /// state.
    pub name: &'static str,
    /// Unit of the physical value.
    pub unit: &'static str,
    /// Meaning of the number and of its sign.
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
    /// An entry whose sign does not change under mirroring.
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
        let position = [("block", block.into()), ("place", index.into())];
        let fields = [name, unit, scale, low, high, mirrored, meaning];
        position.into_iter().chain(fields).collect()
    }

    /// This entry with a sign that changes under mirroring.
    pub(super) const fn odd(self) -> Self {
        Self {
            mirrored: true,
            ..self
        }
    }
}

/// Bounds of cosines, sines and rudders.
pub(super) const UNIT: (f64, f64) = (-1.0, 1.0);
/// Bounds of flags and fractions.
pub(super) const FLAG: (f64, f64) = (0.0, 1.0);
/// Bounds of scaled velocities.
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

/// The last entry of the global state, after boats, phase and target.
#[rustfmt::skip]
pub(super) const CLOCK: [Entry; 1] =
    [Entry::new("episode_elapsed", "", Scale::Plain, FLAG, "part of the episode that is over")];
