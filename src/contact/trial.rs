//! The boats where a solve would move them, and the gaps there.

use super::{Contact, ContactDetector};
use crate::geometry::{Feature, Hull, HullPose, Pose, Velocity, smaller};

/// Poses at a substep's end, on trial.
#[derive(Debug, Clone, Default)]
pub(super) struct Trial {
    poses: Vec<Pose>,
    hulls: Vec<HullPose>,
    /// Whether boats with the velocities that were solved for last end there.
    is_end: bool,
    /// How far each boat's hull moves at most, in cm.
    ways: Vec<f64>,
    /// Boats that are moved again, and whether each boat is one of them.
    listed: Vec<u32>,
    is_listed: Vec<bool>,
}

impl Trial {
    /// Moves boats from these poses with these velocities for `dt`.
    pub(super) fn place(&mut self, poses: &[Pose], velocities: &[Velocity], dt: f64, hull: Hull) {
        let moved = poses
            .iter()
            .zip(velocities)
            .map(|(pose, velocity)| pose.moved(velocity, dt));
        self.poses.clear();
        self.poses.extend(moved);
        HullPose::replace_all(&mut self.hulls, &self.poses);
        self.ways.clear();
        self.ways
            .extend(velocities.iter().map(|each| hull.speed(each) * dt));
        self.is_end = true;
    }

    /// Moves the boats of some islands, given by their contacts, again. The others stay where they are.
    pub(super) fn move_islands<'a>(
        &mut self,
        contacts: &[Contact],
        islands: impl Iterator<Item = &'a [u32]>,
        poses: &[Pose],
        velocities: &[Velocity],
        dt: f64,
        hull: Hull,
    ) {
        self.is_listed.resize(poses.len(), false);
        self.listed.clear();
        for &k in islands.flatten() {
            let contact = &contacts[k as usize];
            let sides = [Some(contact.boat as usize), contact.second()];
            for boat in sides.into_iter().flatten() {
                if !std::mem::replace(&mut self.is_listed[boat], true) {
                    self.listed.push(boat as u32);
                }
            }
        }
        for &boat in &self.listed {
            let boat = boat as usize;
            self.is_listed[boat] = false;
            self.poses[boat] = poses[boat].moved(&velocities[boat], dt);
            self.ways[boat] = hull.speed(&velocities[boat]) * dt;
        }
        HullPose::replace_some(&mut self.hulls, &self.poses, &self.listed);
        self.is_end = true;
    }

    /// Takes note that the velocities are others now.
    pub(super) fn set_old(&mut self) {
        self.is_end = false;
    }

    /// Hands out the poses and hulls of the last trial, if boats end there, for those at the substep's start.
    pub(super) fn take_end(&mut self, poses: &mut Vec<Pose>, hulls: &mut Vec<HullPose>) -> bool {
        if self.is_end {
            std::mem::swap(poses, &mut self.poses);
            std::mem::swap(hulls, &mut self.hulls);
        }
        std::mem::take(&mut self.is_end)
    }

    /// Whether anything found as a contact overlaps by more than `allowed`.
    pub(super) fn overlaps(
        &self,
        detector: &ContactDetector,
        contacts: &[Contact],
        allowed: f64,
    ) -> bool {
        let mut pairs = contacts.chunk_by(|a, b| a.has_ends() && a.is_twin(b));
        pairs.any(|pair| detector.overlaps_at(&pair[0], &self.hulls, allowed))
    }

    /// Whether the boats of a contact move far enough to close it.
    #[inline]
    pub(super) fn may_close(&self, contact: &Contact) -> bool {
        let way = |boat: usize| self.ways[boat];
        contact.gap.gap <= way(contact.boat as usize) + contact.second().map_or(0.0, way)
    }

    /// Whether boats with the velocities that were solved for last end at the trial's poses.
    pub(super) fn is_end(&self) -> bool {
        self.is_end
    }

    /// The gap of contact k. Between two hulls, or a hull and an obstacle, the touch may have passed from
    /// one end to the other without moving: a contact follows it, and the only contact of a pair stands
    /// for the whole pair. `pair` keeps the last such contact and the gaps of its two ends for its twin.
    #[inline]
    pub(super) fn gap(
        &self,
        detector: &ContactDetector,
        contacts: &[Contact],
        k: usize,
        pair: &mut Option<(usize, [f64; 2])>,
    ) -> f64 {
        let contact = &contacts[k];
        let end = match contact.feature {
            Feature::Stern if contact.has_ends() => 0,
            Feature::Bow if contact.has_ends() => 1,
            _ => return detector.gap_at(contact, &self.hulls).gap,
        };
        let is_twin = |other: Option<&Contact>| other.is_some_and(|other| contact.is_twin(other));
        let follows = is_twin(k.checked_sub(1).and_then(|before| contacts.get(before)));
        let gaps = match *pair {
            Some((before, gaps)) if follows && before + 1 == k => gaps,
            _ => detector.end_gaps_at(contact, &self.hulls),
        };
        *pair = Some((k, gaps));
        let gap = if follows || is_twin(contacts.get(k + 1)) {
            gaps[end]
        } else {
            smaller(gaps[0], gaps[1])
        };
        if gap == f64::INFINITY {
            return self.own_gap(detector, contact);
        }
        gap
    }

    /// The gap of a contact where no end faces the other side any more.
    #[cold]
    fn own_gap(&self, detector: &ContactDetector, contact: &Contact) -> f64 {
        detector.gap_at(contact, &self.hulls).gap
    }
}
