//! A steering law on the leader's own view, whatever blocks the leader observes.

use super::entry::{Entry, OWN, TARGET};
use super::view::{FlockView, Scaling, own};
use super::{Block, ObservationLayout, ObservedLaw};
use crate::boat::Law;
use crate::error::Result;
use crate::geometry::LapFrame;
use crate::parameters::FlockParameters;

/// A law that reads what a leader would observe of itself and of the target, rounded as observations are: its
/// rudder has the bits of a policy that evaluates the law.
#[derive(Debug, Clone)]
pub struct LeaderLaw {
    law: ObservedLaw,
    scaling: Scaling,
}

impl LeaderLaw {
    /// For a law and checked parameters.
    ///
    /// # Errors
    /// As for [`Law::check`].
    pub fn new(law: Law, parameters: &FlockParameters) -> Result<Self> {
        let mut layout = ObservationLayout::default();
        for &block in Block::ALL {
            layout.repeat(
                block,
                usize::from(matches!(block, Block::Own | Block::Target)),
            );
        }
        let entries = layout.entries().into_iter();
        let entries = entries.map(|(_, _, entry): (_, _, Entry)| entry);
        Ok(Self {
            law: ObservedLaw::new(law, &layout)?,
            scaling: Scaling::new(entries, parameters),
        })
    }

    /// The rudder of a leader that steers to a heading so many rad outward of the target's tangent; positive
    /// turns counter-clockwise when moving forward.
    pub fn rudder(&self, view: &FlockView, leader: usize, outward: f64) -> f64 {
        let frame = LapFrame::at(view.poses[leader].position);
        let mut physical = [0.0; OWN.len() + TARGET.len()];
        physical[..OWN.len()].copy_from_slice(&own(view, leader, &frame));
        physical[OWN.len()] = view.targets.of(leader).sign();
        let mut observed = [0.0; OWN.len() + TARGET.len()];
        self.scaling.write(&physical, false, &mut observed);
        f64::from(self.law.rudder_about(&observed, outward) as f32)
    }
}
