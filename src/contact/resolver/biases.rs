//! The biases of a substep's contacts: what their gaps may close before anything is solved.

use super::{ContactResolver, Motion};
use crate::contact::touches::twin;
use crate::contact::velocity_bias::VelocityBias;
use crate::contact::{Contact, ContactDetector, Partner};
use crate::geometry::{HullPose, Velocity};

impl ContactResolver {
    /// Computes the biases of all contacts. Where two bodies pushed each other in the substep before, velocities hardly
    /// change, and biases look ahead along the curve of a gap that closes. Gaps count as linear at an impact, where
    /// velocities jump. All gaps do if the fastest boat would move by more than its radius, since velocities before then
    /// say nothing of the substep's end.
    pub(super) fn fill_biases(&mut self, motion: &Motion) {
        let (bias, contacts) = (self.bias(motion), self.contacts.as_slice());
        let linear = |contact: &Contact| {
            let spin = motion.free[contact.boat as usize].angular;
            bias.of_gap(&contact.gap) + bias.of_flank(&contact.gap, spin)
        };
        let is_far = self.detector.farthest > self.detector.hull().radius;
        let is_on = self.relinearization.is_on() && !is_far;
        self.biases.clear();
        let Some(before) = motion.before.filter(|_| is_on) else {
            self.biases.extend(contacts.iter().map(linear));
            return;
        };
        let (persistent, detector) = (&self.persistent, &self.detector);
        let have_pushed = |k| persistent[k] || twin(contacts, k).is_some_and(|k| persistent[k]);
        let looking_ahead = contacts.iter().enumerate().map(|(k, contact)| {
            let curve = if have_pushed(k) {
                closing_curve(detector, contact, motion.hulls, before)
            } else {
                0.0
            };
            linear(contact) + bias.of_curve(&contact.gap, curve)
        });
        self.biases.extend(looking_ahead);
    }

    /// How the biases of this motion follow from gaps.
    pub(super) fn bias(&self, motion: &Motion) -> VelocityBias {
        VelocityBias {
            dt: motion.dt,
            closing_s: motion.dt.max(self.whole_substep_s),
            penetration_slop: self.penetration_slop,
        }
    }
}

/// Second derivative of a contact's gap in cm/s² while its boats keep these velocities, or 0 if it is positive: looking
/// ahead along a curve that opens a gap spares no solve, and lets boats approach that were parting. Therefore it is 0 at
/// the inner wall and at obstacles, too. Meaningless for crossed cores, whose overlap is too deep for it to count.
#[inline]
fn closing_curve(
    detector: &ContactDetector,
    contact: &Contact,
    boats: &[HullPose],
    velocities: &[Velocity],
) -> f64 {
    let moving = |boat: usize| (&boats[boat], &velocities[boat]);
    let (gap, hull) = (&contact.gap, detector.hull());
    let from_center = match contact.partner {
        Partner::Boat(_) => hull.radius,
        Partner::OuterWall => -detector.pool.outer_radius_cm,
        Partner::InnerWall | Partner::Obstacle(_) => return 0.0,
    };
    let distance = gap.gap + hull.radius + from_center;
    let (first, second) = (moving(contact.boat as usize), contact.second().map(moving));
    gap.second_derivative(hull, distance, first, second)
        .min(0.0)
}
