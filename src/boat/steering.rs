//! Steering laws of leaders: the paper's, eq. (10), and the damped law, which also steers well when backing.

use crate::error::{FlockError, Result};
use crate::geometry::{Vec2, wrap_angle};
use crate::parameters::Target;
use std::f64::consts::{FRAC_PI_2, PI};

/// Rudder command of eq. (10): s = clamp(6·(β − α)/π, −1, 1), with β − α wrapped into (−π, π];
/// proportional up to 30° of misalignment, constant beyond.
pub fn steering_law(misalignment: f64) -> f64 {
    (6.0 * wrap_angle(misalignment) / PI).clamp(-1.0, 1.0)
}

/// β − α of a boat in rad: how far it has to turn counter-clockwise to head along the target's tangent at
/// its polar angle θ. The tangent of clockwise motion points along θ − π/2.
pub fn misalignment(position: Vec2, heading: f64, target: Target) -> f64 {
    let polar_angle = libm::atan2(position.y, position.x);
    wrap_angle(polar_angle - target.sign() * FRAC_PI_2 - heading)
}

/// State of a leader that a steering law reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// Angle in rad by which the leader must turn counter-clockwise to reach its desired heading; not wrapped.
    pub misalignment: f64,
    /// Velocity along the heading, in any unit: only its sign matters.
    pub forward: f64,
    /// Angular velocity in rad/s, counter-clockwise.
    pub angular: f64,
}

/// A steering law for both directions of motion. While a boat moves forward, s = clamp(gain·δ, −1, 1), where δ is the
/// misalignment. While it backs, a rudder works in reverse: s = clamp(−backward_gain·δ + damping·α̇, −1, 1). The second
/// term damps the spin of a backing boat.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DampedLaw {
    /// Rudder per rad of misalignment while moving forward.
    pub gain: f64,
    /// Rudder per rad of misalignment while moving backward.
    pub backward_gain: f64,
    /// Rudder per rad/s of angular velocity while moving backward.
    pub damping: f64,
}

/// The gain of eq. (10) in 1/rad: full rudder from 30° of misalignment on.
const PAPER_GAIN: f64 = 6.0 / PI;

/// The untuned damped law: eq. (10)'s gain in both directions.
impl Default for DampedLaw {
    fn default() -> Self {
        Self {
            gain: PAPER_GAIN,
            backward_gain: PAPER_GAIN,
            damping: 3.0,
        }
    }
}

impl DampedLaw {
    /// The tuned law: the damped law with the gains tuned in a pool, by the pool's name.
    ///
    /// Source: `studies/tuned_laws`, results version 1. CMA-ES (seed 0) searched for three leaders among 27 boats at
    /// each pool's critical noise, on training seeds. The study keeps its candidates and their scores; a test finds
    /// these gains from them. A longer search (results version 4) found no better ones.
    pub const TUNED: [(&str, Self); 2] = [
        (
            "wide",
            Self {
                gain: 1.42,
                backward_gain: 3.28,
                damping: 17.0,
            },
        ),
        (
            "narrow",
            Self {
                gain: 3.02,
                backward_gain: 4.1,
                damping: 35.6,
            },
        ),
    ];

    /// The tuned law of a pool. `setting` and its `value`, which ask for the law, are named in the error.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the law has not been tuned in the pool.
    pub fn tuned(setting: &'static str, value: &str, pool: Option<&str>) -> Result<Self> {
        let mut tuned = Self::TUNED.into_iter();
        let entry = tuned.find(|(name, _)| Some(*name) == pool);
        entry.map(|(_, law)| law).ok_or_else(|| {
            let pools = Self::TUNED.map(|(name, _)| name).join(" and ");
            let accepted = format!("the damped law is tuned only in the pools {pools}");
            FlockError::parameter(setting, value, accepted)
        })
    }

    /// Names and values of the gains.
    pub fn gains(&self) -> [(&'static str, f64); 3] {
        [
            ("gain", self.gain),
            ("backward_gain", self.backward_gain),
            ("damping", self.damping),
        ]
    }

    /// Checks the gains.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a gain that is not finite or exceeds 1e9 in magnitude.
    pub fn check(&self) -> Result<()> {
        self.gains().into_iter().try_for_each(|(name, value)| {
            FlockError::unless(
                value.abs() <= 1e9,
                name,
                value,
                "a finite number from -1e9 to 1e9",
            )
        })
    }

    /// The rudder command in [−1, 1] of a leader in this state.
    pub fn rudder(&self, course: &Course) -> f64 {
        let misalignment = wrap_angle(course.misalignment);
        let rudder = if course.forward < 0.0 {
            self.damping * course.angular - self.backward_gain * misalignment
        } else {
            self.gain * misalignment
        };
        rudder.clamp(-1.0, 1.0)
    }
}
