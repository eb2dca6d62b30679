//! Steering laws of leaders: the paper's fixed one, eq. (10), and closed forms beyond it.

use crate::error::{FlockError, Result};
use crate::geometry::{Vec2, wrap_angle};
use crate::parameters::{Pool, Target};
use std::f64::consts::{FRAC_PI_2, PI};

/// Rudder command of eq. (10): s = clamp(6·(β − α)/π, −1, 1), with β − α wrapped into (−π, π];
/// proportional up to 30° of misalignment, constant beyond.
pub fn steering_law(misalignment: f64) -> f64 {
    (6.0 * wrap_angle(misalignment) / PI).clamp(-1.0, 1.0)
}

/// β − α of a boat: how far counter-clockwise it has to turn to head along the target's tangent at
/// its own polar angle θ. Clockwise motion heads along θ − π/2.
pub fn misalignment(position: Vec2, heading: f64, target: Target) -> f64 {
    let polar_angle = libm::atan2(position.y, position.x);
    wrap_angle(polar_angle - target.sign() * FRAC_PI_2 - heading)
}

/// A steering law. Misalignment δ = β − α is how far counter-clockwise the leader has to turn to head
/// along the target's tangent, wrapped into (−π, π].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Eq. (10): s = clamp(6·δ/π, −1, 1).
    Steering,
    /// s = sign(u·ẋ)·clamp(gain·δ, −1, 1): a rudder works in reverse on a boat that moves backward.
    SignCorrected {
        /// Rudder per rad of misalignment; 6/π in eq. (10).
        gain: f64,
    },
    /// Forward as `SignCorrected`; backward s = clamp(−backward_gain·δ + damping·α̇, −1, 1), which also
    /// counters the turning that makes backing boats spin.
    Damped {
        /// Rudder per rad of misalignment while moving forward.
        gain: f64,
        /// Rudder per rad of misalignment while moving backward.
        backward_gain: f64,
        /// Rudder per rad/s of angular velocity while moving backward.
        damping: f64,
    },
}

/// The gain of eq. (10) in 1/rad: full rudder from 30° of misalignment on.
pub(crate) const PAPER_GAIN: f64 = 6.0 / PI;

/// The damped law where nothing has been tuned: eq. (10)'s gain in both directions.
pub const DAMPED_LAW: Law = Law::Damped {
    gain: PAPER_GAIN,
    backward_gain: PAPER_GAIN,
    damping: 3.0,
};

/// Laws with the gains tuned in a named pool: (name of the law, pool, law).
///
/// Source: `python baselines/tune_laws.py` (seed 0) for three leaders among 27 boats at each pool's critical
/// noise, on training seeds.
pub const TUNED_LAWS: [(&str, &str, Law); 4] = [
    (
        "sign-corrected law",
        "wide",
        Law::SignCorrected { gain: 1.91 },
    ),
    (
        "sign-corrected law",
        "narrow",
        Law::SignCorrected { gain: 0.957 },
    ),
    (
        "damped law",
        "wide",
        Law::Damped {
            gain: 1.42,
            backward_gain: 3.28,
            damping: 17.0,
        },
    ),
    (
        "damped law",
        "narrow",
        Law::Damped {
            gain: 3.02,
            backward_gain: 4.1,
            damping: 35.6,
        },
    ),
];

/// The damped law of each pool in which it has been tuned.
fn tuned_damped() -> impl Iterator<Item = (&'static str, Law)> {
    let tuned = TUNED_LAWS.into_iter();
    tuned.filter_map(|(_, pool, law)| matches!(law, Law::Damped { .. }).then_some((pool, law)))
}

impl Law {
    /// Names and values of the gains.
    pub fn gains(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Steering => Vec::new(),
            Self::SignCorrected { gain } => vec![("gain", gain)],
            Self::Damped {
                gain,
                backward_gain,
                damping,
            } => vec![
                ("gain", gain),
                ("backward_gain", backward_gain),
                ("damping", damping),
            ],
        }
    }

    /// The damped law with the gains tuned in a pool; `None` for pools in which it has not been tuned.
    pub(crate) fn tuned_damped(pool: &Pool) -> Option<Self> {
        let pool = pool.name()?;
        tuned_damped().find_map(|(of, law)| (of == pool).then_some(law))
    }

    /// The pools in which the damped law has been tuned.
    pub(crate) fn tuned_damped_pools() -> impl Iterator<Item = &'static str> {
        tuned_damped().map(|(pool, _)| pool)
    }

    /// Checks the gains.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for gains that are not finite.
    pub fn check(&self) -> Result<()> {
        match self
            .gains()
            .into_iter()
            .find(|(_, value)| value.is_nan() || value.abs() > 1e9)
        {
            Some((name, value)) => Err(FlockError::parameter(name, value, "a finite number")),
            None => Ok(()),
        }
    }

    /// The rudder in [−1, 1] for a misalignment in rad, a velocity along the heading (its sign counts)
    /// and an angular velocity in rad/s, counter-clockwise.
    pub fn rudder(&self, misalignment: f64, forward: f64, angular: f64) -> f64 {
        let backing = forward < 0.0;
        match *self {
            Self::Steering => steering_law(misalignment),
            Self::SignCorrected { gain } => {
                let turn = (gain * wrap_angle(misalignment)).clamp(-1.0, 1.0);
                if backing { -turn } else { turn }
            }
            Self::Damped {
                gain,
                backward_gain,
                damping,
            } => {
                let misalignment = wrap_angle(misalignment);
                let rudder = if backing {
                    damping * angular - backward_gain * misalignment
                } else {
                    gain * misalignment
                };
                rudder.clamp(-1.0, 1.0)
            }
        }
    }
}
