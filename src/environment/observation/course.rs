//! The course of a leader, which steering laws read. It comes from an observation, or from a flock with the same
//! rounding as an observation.

use super::blocks::{Block, OWN, TARGET, own_values};
use super::view::{FlockView, Scaling};
use super::{ANGULAR_VELOCITY_SCALE, ObservationLayout};
use crate::boat::Course;
use crate::error::{FlockError, Result};
use crate::geometry::LapFrame;
use crate::parameters::FlockParameters;

/// Reads a leader's course from observations of one layout. The fields are indices of entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CourseReader {
    cos_orientation: usize,
    sin_orientation: usize,
    forward_velocity: usize,
    clockwise_spin: usize,
    /// `None` if the observation is mirrored, so that the target is always clockwise.
    target: Option<usize>,
}

impl CourseReader {
    /// A reader of observations in a checked layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if a block that the laws read is switched off.
    pub fn new(layout: &ObservationLayout) -> Result<Self> {
        let index = |block: Block, name: &str| {
            layout.index(block, name).ok_or_else(|| {
                let accepted = "the steering laws read this block; switch it on";
                FlockError::parameter("observation", format!("{}: off", block.name()), accepted)
            })
        };
        Ok(Self {
            cos_orientation: index(Block::Own, "cos_orientation")?,
            sin_orientation: index(Block::Own, "sin_orientation")?,
            forward_velocity: index(Block::Own, "forward_velocity")?,
            clockwise_spin: index(Block::Own, "clockwise_spin")?,
            target: if layout.is_mirrored {
                None
            } else {
                Some(index(Block::Target, "target")?)
            },
        })
    }

    /// The course relative to a heading that leans outward of the target's tangent by `outward` (rad). If the
    /// observation is mirrored, so is the course.
    pub fn course(&self, observation: &[f32], outward: f64) -> Course {
        let read = |index: usize| f64::from(observation[index]);
        let target = self.target.map_or(1.0, read);
        // δ = φ − φ_target with φ_target = ±π/2.
        let sin = -target * read(self.cos_orientation);
        let cos = target * read(self.sin_orientation);
        let mut misalignment = libm::atan2(sin, cos);
        if outward != 0.0 {
            // Outward of the tangent is counter-clockwise for a clockwise target.
            misalignment += target * outward;
        }
        Course {
            misalignment,
            forward: read(self.forward_velocity),
            angular: -ANGULAR_VELOCITY_SCALE * read(self.clockwise_spin),
        }
    }
}

/// Reads leaders' courses from the view of a flock, bit for bit as from observations.
#[derive(Debug, Clone)]
pub struct CourseView {
    reader: CourseReader,
    scaling: Scaling,
}

impl CourseView {
    /// A reader for flocks with these checked parameters.
    ///
    /// # Errors
    /// Never: the layout has all blocks that the laws read.
    pub fn new(parameters: &FlockParameters) -> Result<Self> {
        let layout = ObservationLayout::from_blocks(&[Block::Own, Block::Target]);
        let entries = layout.entries().into_iter().map(|(_, _, entry)| entry);
        Ok(Self {
            reader: CourseReader::new(&layout)?,
            scaling: Scaling::new(entries, parameters),
        })
    }

    /// The course of a leader relative to a heading that leans outward of its target's tangent by `outward` (rad).
    pub fn course(&self, view: &FlockView, leader: usize, outward: f64) -> Course {
        let frame = LapFrame::at(view.poses[leader].position);
        let mut physical = [0.0; OWN.len() + TARGET.len()];
        physical[..OWN.len()].copy_from_slice(&own_values(view, leader, &frame));
        physical[OWN.len()] = view.targets.of(leader).sign();
        let mut observed = [0.0; OWN.len() + TARGET.len()];
        let is_mirrored = false;
        self.scaling.write(&physical, is_mirrored, &mut observed);
        self.reader.course(&observed, outward)
    }
}
