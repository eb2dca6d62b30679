//! Steering laws evaluated from what a leader observes.

use super::{ANGULAR_VELOCITY_SCALE, Block, ObservationLayout};
use crate::boat::Law;
use crate::error::{FlockError, Result};

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
        self.rudder_about(observation, 0.0)
    }

    /// The same where the desired heading is turned outward of the target's tangent by an angle in rad.
    pub(crate) fn rudder_about(&self, observation: &[f32], outward: f64) -> f64 {
        let read = |place: usize| f64::from(observation[place]);
        let target = self.target.map_or(1.0, read);
        // δ = φ − φ_target with φ_target = ±π/2.
        let sin = -target * read(self.cos_orientation);
        let cos = target * read(self.sin_orientation);
        let mut misalignment = libm::atan2(sin, cos);
        if outward != 0.0 {
            // Outward of the tangent is counter-clockwise for a clockwise target.
            misalignment += target * outward;
        }
        let spin = ANGULAR_VELOCITY_SCALE * read(self.clockwise_spin);
        self.law
            .rudder(misalignment, read(self.forward_velocity), -spin)
    }
}
