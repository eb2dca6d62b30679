//! The biases of a substep's contacts: what their gaps may close before anything is solved.

use super::{ContactResolver, Motion};
use crate::contact::touches::twin;
use crate::contact::velocity_bias::VelocityBias;
use crate::contact::{Contact, ContactDetector, Partner};
use crate::geometry::{HullPose, Obstacle, Velocity};

impl ContactResolver {
    /// Computes the biases of all contacts. Where two bodies pushed each other in the substep before, velocities hardly
    /// change, and biases look ahead along the curve of the gap. Gaps count as linear at an impact, where velocities jump,
    /// and at a straight wall: a touch there may come from the wall beside it. All gaps do if the fastest boat would move
    /// by more than its radius, since velocities before then say nothing of the substep's end.
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
        let persistent = &self.persistent;
        let have_pushed = |k| persistent[k] || twin(contacts, k).is_some_and(|k| persistent[k]);
        let detector = &self.detector;
        let curve = |contact| second_derivative(detector, contact, motion.hulls, before);
        let looking_ahead = contacts.iter().enumerate().map(|(k, contact)| {
            if have_pushed(k)
                && let Some(curve) = curve(contact)
            {
                bias.of_gap(&contact.gap) + bias.of_curve(&contact.gap, curve)
            } else {
                linear(contact)
            }
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

/// Second derivative of a contact's gap in cm/s², if its boats keep these velocities; `None` at a straight wall.
/// Meaningless for crossed cores, whose overlap is too deep for it to count.
#[inline]
fn second_derivative(
    detector: &ContactDetector,
    contact: &Contact,
    boats: &[HullPose],
    velocities: &[Velocity],
) -> Option<f64> {
    let moving = |boat: usize| (&boats[boat], &velocities[boat]);
    let (gap, hull, pool) = (&contact.gap, detector.hull(), detector.pool);
    let from_center = match contact.partner {
        Partner::Boat(_) => hull.radius,
        Partner::OuterWall => -pool.outer_radius_cm,
        Partner::InnerWall => pool.inner_radius_cm,
        Partner::Obstacle(number) => match detector.obstacles.obstacles[number as usize] {
            Obstacle::Disc { radius, .. } => radius,
            Obstacle::Wall { .. } => return None,
        },
    };
    let distance = gap.gap + hull.radius + from_center;
    let (first, second) = (moving(contact.boat as usize), contact.second().map(moving));
    Some(gap.second_derivative(hull, distance, first, second))
}
