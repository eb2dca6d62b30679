//! The biases of a substep's contacts before the first solve.

use super::{ContactResolver, Motion};
use crate::contact::touches::twin;
use crate::contact::velocity_bias::VelocityBias;
use crate::contact::{Contact, ContactDetector, Partner};
use crate::geometry::{HullPose, Obstacle, Velocity};

impl ContactResolver {
    /// Computes the biases of all contacts. If two bodies pushed each other in the substep before, their velocities hardly
    /// change, and the bias looks ahead along the curve of a closing gap. Velocities jump at an impact, so the gap of a new
    /// contact counts as linear.
    pub(super) fn fill_biases(&mut self, motion: &Motion) {
        let (bias, contacts) = (self.bias(motion), self.contacts.as_slice());
        let linear = |contact: &Contact| {
            let spin = motion.free[contact.boat as usize].angular;
            bias.for_gap(&contact.gap) + bias.for_flank(&contact.gap, spin)
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
            linear(contact) + bias.for_curve(&contact.gap, curve)
        });
        self.biases.extend(looking_ahead);
    }

    /// Computes the biases of all contacts again, and also looks ahead along curves that open a gap. Without that, a closed
    /// ring of moving boats has no solution: its gaps at the wall close, and those between boats open. Returns whether gaps
    /// may count as curved. If not, the biases stay as they are.
    #[cold]
    pub(super) fn look_ahead_along_all_curves(&mut self, motion: &Motion) -> bool {
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
                self.biases[k] = bias.for_gap(&contact.gap) + bias.for_curve(&contact.gap, curve);
            }
        }
        true
    }

    /// The velocities before the substep; `None` if gaps count as linear. They do if the fastest boat would move by more
    /// than its radius, since the velocities at the substep's end then differ too much.
    fn velocities_before<'a>(&self, motion: &Motion<'a>) -> Option<&'a [Velocity]> {
        let is_too_far = self.detector.farthest > self.detector.hull().radius;
        let is_curved = self.relinearization.is_on() && !is_too_far;
        motion.before.filter(|_| is_curved)
    }

    /// The rule by which biases follow from gaps in this substep.
    pub(super) fn bias(&self, motion: &Motion) -> VelocityBias {
        VelocityBias {
            dt: motion.dt,
            closing_s: motion.dt.max(self.whole_substep_s),
            penetration_slop: self.penetration_slop,
        }
    }
}

/// Whether the two bodies of contact k pushed each other in the substep before. `persistent` tells whether each contact
/// did.
#[inline]
fn have_pushed(persistent: &[bool], contacts: &[Contact], k: usize) -> bool {
    persistent[k] || twin(contacts, k).is_some_and(|k| persistent[k])
}

/// Second derivative of a contact's gap in cm/s² while its boats keep these velocities, or 0 if it is positive. Looking
/// ahead along a curve that opens a gap saves no solve, and after an impact it would let boats approach further. It is
/// also 0 at the inner wall and obstacles, whose gaps mostly open along their curves.
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

/// Second derivative of a contact's gap in cm/s² while its boats keep these velocities; `None` at a straight wall, since
/// the touch may have come from an adjacent wall. Meaningless for crossed cores, but then the overlap is so deep that the
/// value is not used.
// `inline` alone does not suffice, since this is also called from a cold function.
#[inline(always)]
fn second_derivative(
    detector: &ContactDetector,
    contact: &Contact,
    boats: &[HullPose],
    velocities: &[Velocity],
) -> Option<f64> {
    let moving = |boat: usize| (&boats[boat], &velocities[boat]);
    let (gap, hull, pool) = (&contact.gap, detector.hull(), detector.pool);
    // Negative at the outer wall, which curves around the hull.
    let partner_radius = match contact.partner {
        Partner::Boat(_) => hull.radius,
        Partner::OuterWall => -pool.outer_radius_cm,
        Partner::InnerWall => pool.inner_radius_cm,
        Partner::Obstacle(number) => match detector.obstacles.obstacles[number as usize] {
            Obstacle::Disc { radius, .. } => radius,
            Obstacle::Wall { .. } => return None,
        },
    };
    let distance = gap.gap + hull.radius + partner_radius;
    let (first, second) = (moving(contact.boat as usize), contact.second().map(moving));
    Some(gap.second_derivative(hull, distance, first, second))
}
