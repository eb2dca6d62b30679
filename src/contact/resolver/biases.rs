//! The biases of a substep's contacts: what their gaps may close before anything is solved.

use super::{ContactResolver, Motion};
use crate::contact::touches::twin;
use crate::contact::velocity_bias::VelocityBias;
use crate::contact::{Contact, ContactDetector, Partner};
use crate::geometry::{HullPose, Obstacle, Velocity};

impl ContactResolver {
    /// Computes the biases of all contacts. Where two bodies pushed each other in the substep before, velocities hardly
    /// change, and biases look ahead along the curve of a gap that closes. Gaps count as linear at an impact, where
    /// velocities jump.
    pub(super) fn fill_biases(&mut self, motion: &Motion) {
        let (bias, contacts) = (self.bias(motion), self.contacts.as_slice());
        let linear = |contact: &Contact| {
            let spin = motion.free[contact.boat as usize].angular;
            bias.of_gap(&contact.gap) + bias.of_flank(&contact.gap, spin)
        };
        let before = self.velocities_before(motion);
        self.biases.clear();
        let Some(before) = before else {
            self.biases.extend(contacts.iter().map(linear));
            return;
        };
        let detector = &self.detector;
        let looking_ahead = contacts.iter().enumerate().map(|(k, contact)| {
            let curve = if have_pushed(&self.persistent, contacts, k) {
                closing_curve(detector, contact, motion.hulls, before)
            } else {
                0.0
            };
            linear(contact) + bias.of_curve(&contact.gap, curve)
        });
        self.biases.extend(looking_ahead);
    }

    /// Computes the biases of all contacts again, and looks ahead also along curves that open a gap. A closed ring of boats
    /// under way has no other solution: its gaps at the wall close, and those between boats open. Returns whether gaps may
    /// count as curved; if not, the biases stay as they are.
    #[cold]
    pub(super) fn look_ahead_along_all(&mut self, motion: &Motion) -> bool {
        let Some(before) = self.velocities_before(motion) else {
            return false;
        };
        self.fill_biases(motion);
        let (bias, contacts) = (self.bias(motion), self.contacts.as_slice());
        for (k, contact) in contacts.iter().enumerate() {
            if have_pushed(&self.persistent, contacts, k)
                && let Some(curve) =
                    second_derivative(&self.detector, contact, motion.hulls, before)
            {
                self.biases[k] = bias.of_gap(&contact.gap) + bias.of_curve(&contact.gap, curve);
            }
        }
        true
    }

    /// The velocities before the substep, if gaps may count as curved. They may not if the fastest boat would move by more
    /// than its radius, since these velocities then say nothing of the substep's end.
    fn velocities_before<'a>(&self, motion: &Motion<'a>) -> Option<&'a [Velocity]> {
        let is_far = self.detector.farthest > self.detector.hull().radius;
        let is_on = self.relinearization.is_on() && !is_far;
        motion.before.filter(|_| is_on)
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

/// Whether the two bodies of a contact pushed each other in the substep before. `persistent` says it of each contact.
#[inline]
fn have_pushed(persistent: &[bool], contacts: &[Contact], k: usize) -> bool {
    persistent[k] || twin(contacts, k).is_some_and(|k| persistent[k])
}

/// Second derivative of a contact's gap in cm/s² while its boats keep these velocities, or 0 if it is positive: looking
/// ahead along a curve that opens a gap spares no solve, and after an impact it would let boats approach further.
/// Therefore it is 0 at walls inside the pool, too.
#[inline]
fn closing_curve(
    detector: &ContactDetector,
    contact: &Contact,
    boats: &[HullPose],
    velocities: &[Velocity],
) -> f64 {
    match contact.partner {
        Partner::InnerWall | Partner::Obstacle(_) => 0.0,
        Partner::Boat(_) | Partner::OuterWall => {
            second_derivative(detector, contact, boats, velocities)
                .map_or(0.0, |curve| curve.min(0.0))
        }
    }
}

/// Second derivative of a contact's gap in cm/s² while its boats keep these velocities; `None` at a straight wall, where a
/// touch may come from the wall beside it. Meaningless for crossed cores, whose overlap is too deep for it to count.
// Always, since it is also called where speed does not matter.
#[inline(always)]
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
