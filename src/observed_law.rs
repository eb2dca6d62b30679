//! Closed-form steering laws evaluated from what a leader observes.

use crate::boat::steering_law;
use crate::error::{FlockError, Result};
use crate::geometry::wrap_angle;
use crate::observation::{ANGULAR_VELOCITY_SCALE, Block, ObservationLayout};
use std::f64::consts::PI;

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
pub const PAPER_GAIN: f64 = 6.0 / PI;

impl Law {
    /// Checks the gains.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for gains that are not finite.
    pub fn check(&self) -> Result<()> {
        let gains = match *self {
            Self::Steering => [("gain", PAPER_GAIN), ("", 0.0), ("", 0.0)],
            Self::SignCorrected { gain } => [("gain", gain), ("", 0.0), ("", 0.0)],
            Self::Damped {
                gain,
                backward_gain,
                damping,
            } => [
                ("gain", gain),
                ("backward_gain", backward_gain),
                ("damping", damping),
            ],
        };
        match gains
            .iter()
            .find(|(_, value)| value.is_nan() || value.abs() > 1e9)
        {
            Some(&(name, value)) => Err(FlockError::parameter(name, value, "a finite number")),
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

/// A law that reads observations of one layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedLaw {
    law: Law,
    size: usize,
    cos_orientation: usize,
    sin_orientation: usize,
    forward_velocity: usize,
    clockwise_spin: usize,
    /// `None` where the observation is mirrored, so that the target is always clockwise.
    target: Option<usize>,
}

impl ObservedLaw {
    /// A law for observations of a checked layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if a block that the law reads is switched off.
    pub fn new(law: Law, layout: &ObservationLayout) -> Result<Self> {
        law.check()?;
        let place = |block: Block, name: &str| {
            layout.place(block, name).ok_or_else(|| {
                let accepted = "the steering laws read this block; switch it on";
                FlockError::parameter("observation", format!("{}: off", block.name()), accepted)
            })
        };
        Ok(Self {
            law,
            size: layout.size(),
            cos_orientation: place(Block::Own, "cos_orientation")?,
            sin_orientation: place(Block::Own, "sin_orientation")?,
            forward_velocity: place(Block::Own, "forward_velocity")?,
            clockwise_spin: place(Block::Own, "clockwise_spin")?,
            target: if layout.mirror_to_target {
                None
            } else {
                Some(place(Block::Target, "target")?)
            },
        })
    }

    /// How many numbers an observation has.
    pub fn observation_size(&self) -> usize {
        self.size
    }

    /// The rudder for one observation, in the observation's own sense where it is mirrored.
    pub fn rudder(&self, observation: &[f32]) -> f64 {
        let read = |place: usize| f64::from(observation[place]);
        let target = self.target.map_or(1.0, read);
        // δ = φ − φ_target with φ_target = ±π/2.
        let sin = -target * read(self.cos_orientation);
        let cos = target * read(self.sin_orientation);
        let spin = ANGULAR_VELOCITY_SCALE * read(self.clockwise_spin);
        self.law
            .rudder(sin.atan2(cos), read(self.forward_velocity), -spin)
    }
}
