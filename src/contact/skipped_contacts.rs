//! Skipped contacts: those that boats would not close at their free velocities. They are left out of the contact problem
//! as long as its solution does not close them either.

use super::predicted_poses::PredictedPoses;
use super::{Contact, ContactDetector, Partner};
use crate::geometry::Velocity;

/// Impulses rarely displace a boat by more than this fraction of the fastest boat's displacement. With a larger fraction,
/// fewer contacts are skipped; with a smaller one, more have to be restored.
const PUSHED_SHARE: f64 = 0.125;

/// The contacts that are skipped.
#[derive(Debug, Clone, Default)]
pub(super) struct SkippedContacts {
    contacts: Vec<Contact>,
}

impl SkippedContacts {
    /// Forgets the skipped contacts.
    pub(super) fn clear(&mut self) {
        self.contacts.clear();
    }

    /// Whether there are no skipped contacts.
    pub(super) fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Moves contacts from `contacts` to the skipped ones if boats with these velocities do not close them within `dt`.
    /// Both touches of two bodies are kept or skipped together, since closing one moves the other.
    pub(super) fn skip_open(
        &mut self,
        detector: &ContactDetector,
        velocities: &[Velocity],
        dt: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let push_cm = PUSHED_SHARE * (detector.farthest + 1e-3 * detector.hull().radius);
        let (mut kept_count, mut next) = (0, 0);
        while next < contacts.len() {
            let touches = &contacts[next..(next + 2).min(contacts.len())];
            let count = match touches {
                [first, second] if first.is_twin(second) => 2,
                _ => 1,
            };
            let is_kept = may_close(detector, &touches[..count], velocities, dt, push_cm);
            for _ in 0..count {
                if is_kept {
                    contacts[kept_count] = contacts[next];
                    kept_count += 1;
                } else {
                    self.contacts.push(contacts[next]);
                }
                next += 1;
            }
        }
        contacts.truncate(kept_count);
    }

    /// Whether no skipped contact overlaps by more than `allowed` at the poses predicted for these velocities and `dt`.
    pub(super) fn stay_open(
        &self,
        predicted: &PredictedPoses,
        detector: &ContactDetector,
        velocities: &[Velocity],
        dt: f64,
        allowed: f64,
    ) -> bool {
        let are_open = |touches: &[Contact]| {
            // If one wall continues another, the nearer touch may be missing, so the other touch proves nothing.
            let is_obstacle = matches!(touches[0].partner, Partner::Obstacle(_));
            let cannot_close = !is_obstacle && !may_close(detector, touches, velocities, dt, 0.0);
            debug_assert!(!cannot_close || !predicted.overlaps(detector, touches, allowed));
            cannot_close || !predicted.overlaps(detector, touches, allowed)
        };
        self.is_empty()
            || predicted.is_current() && self.contacts.chunk_by(Contact::is_twin).all(are_open)
    }

    /// Moves the skipped contacts back to the others; returns their number.
    pub(super) fn restore(&mut self, contacts: &mut Vec<Contact>) -> u64 {
        let count = self.contacts.len() as u64;
        contacts.append(&mut self.contacts);
        count
    }
}

/// Whether boats with these velocities may close the one or two touches of two bodies within `dt`, if other contacts
/// displace each boat by up to `push_cm`.
#[inline]
fn may_close(
    detector: &ContactDetector,
    touches: &[Contact],
    velocities: &[Velocity],
    dt: f64,
    push_cm: f64,
) -> bool {
    let closes = |contact: &Contact| may_close_touch(detector, contact, velocities, dt, push_cm);
    match touches {
        // At the outer wall, which curves around the boat, one end's normal says nothing about the other end.
        [a, b] if a.partner == Partner::OuterWall => closes(a) || closes(b),
        [a, b] if b.gap.gap < a.gap.gap => closes(b),
        touches => closes(&touches[0]),
    }
}

/// As [`may_close`], from the nearer touch alone. Its normal separates the two bodies: along it their cores approach no
/// faster than their centers do, plus what turning adds at their ends.
#[inline]
fn may_close_touch(
    detector: &ContactDetector,
    contact: &Contact,
    velocities: &[Velocity],
    dt: f64,
    push_cm: f64,
) -> bool {
    let hull = detector.hull();
    let gap = &contact.gap;
    let first = &velocities[contact.boat as usize];
    let (linear, spin, push_cm) = match contact.second() {
        Some(second) => {
            let second = &velocities[second];
            let spin = first.angular.abs() + second.angular.abs();
            (first.linear - second.linear, spin, 2.0 * push_cm)
        }
        None => (first.linear, first.angular.abs(), push_cm),
    };
    let swing = hull.half_length * spin * dt;
    // The outer wall curves towards a boat that moves along it.
    let curve = if contact.partner == Partner::OuterWall {
        let displacement = linear.norm() * dt + swing;
        0.5 * displacement * displacement / (detector.pool.outer_radius_cm - hull.radius - gap.gap)
    } else {
        0.0
    };
    gap.gap < 0.0 || gap.gap + gap.normal.dot(&linear) * dt < swing + curve + push_cm
}
