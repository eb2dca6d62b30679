//! Poses to which a solve would move the boats, and the gaps at those poses.

use super::depenetration::smallest_gap;
use super::touches::{are_swapped, first_of_two};
use super::{Contact, ContactDetector};
use crate::geometry::{Hull, HullPose, Pose, Velocity};

/// Poses at the end of a substep, as the last solve predicts them.
#[derive(Debug, Clone, Default)]
pub(super) struct PredictedPoses {
    poses: Vec<Pose>,
    hulls: Vec<HullPose>,
    /// Whether these poses follow from the velocities of the last solve.
    is_current: bool,
    /// Upper bound in cm of how far each boat's core moves.
    displacements: Vec<f64>,
    /// Boats whose prediction is repeated.
    listed: Vec<u32>,
    /// Whether each boat is in `listed`; all false between calls.
    is_listed: Vec<bool>,
}

impl PredictedPoses {
    /// Predicts all poses: boats move from these poses with these velocities for `dt`.
    pub(super) fn predict(&mut self, poses: &[Pose], velocities: &[Velocity], dt: f64, hull: Hull) {
        let moved = poses
            .iter()
            .zip(velocities)
            .map(|(pose, velocity)| pose.moved(velocity, dt));
        self.poses.clear();
        self.poses.extend(moved);
        HullPose::replace_all(&mut self.hulls, &self.poses);
        self.displacements.clear();
        self.displacements
            .extend(velocities.iter().map(|velocity| hull.speed(velocity) * dt));
        self.is_current = true;
    }

    /// Repeats the prediction for the boats of some islands. Each island is given as the list of its contacts.
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
            self.displacements[boat] = hull.speed(&velocities[boat]) * dt;
        }
        HullPose::replace_some(&mut self.hulls, &self.poses, &self.listed);
        self.is_current = true;
    }

    /// Whether a boat moves beyond its reach, and bodies overlap at the predicted poses. Only overlaps count that exceed
    /// the tolerance, and the deepest overlap of `contacts` at the substep's start.
    pub(super) fn overlaps_undetected(
        &self,
        detector: &mut ContactDetector,
        contacts: &[Contact],
        tolerance: f64,
    ) -> bool {
        debug_assert!(self.is_current);
        detector.is_outrun(&self.displacements) && {
            let allowed = tolerance.max(-smallest_gap(contacts));
            detector.may_overlap_undetected(&self.hulls, &self.displacements, allowed)
        }
    }

    /// Marks the prediction as outdated: velocities have changed.
    pub(super) fn set_outdated(&mut self) {
        self.is_current = false;
    }

    /// If the prediction is up to date, swaps the predicted poses and hulls with those at the substep's start, and
    /// marks the prediction as outdated. Returns whether it was up to date.
    pub(super) fn take_poses(&mut self, poses: &mut Vec<Pose>, hulls: &mut Vec<HullPose>) -> bool {
        if self.is_current {
            std::mem::swap(poses, &mut self.poses);
            std::mem::swap(hulls, &mut self.hulls);
        }
        std::mem::take(&mut self.is_current)
    }

    /// Whether the two bodies of any contact overlap by more than `allowed` at the predicted poses.
    pub(super) fn overlaps(
        &self,
        detector: &ContactDetector,
        contacts: &[Contact],
        allowed: f64,
    ) -> bool {
        let mut pairs = contacts.chunk_by(|a, b| a.has_ends() && a.is_twin(b));
        // The check of a contact at one end covers both ends.
        pairs.any(|pair| detector.overlaps_at(&pair[0], &self.hulls, allowed))
    }

    /// As [`Self::overlaps`], but ignores contacts that their boats move too little to close.
    pub(super) fn closing_overlaps(
        &self,
        detector: &ContactDetector,
        contacts: &[Contact],
        allowed: f64,
    ) -> bool {
        // Most contacts are too far apart to close, so the check for a twin comes second.
        let mut last_checked: Option<&Contact> = None;
        contacts.iter().any(|contact| {
            if contact.gap.gap > self.summed_displacement(contact) {
                return false;
            }
            let is_checked =
                last_checked.is_some_and(|twin| contact.has_ends() && twin.is_twin(contact));
            last_checked = Some(contact);
            !is_checked && detector.overlaps_at(contact, &self.hulls, allowed)
        })
    }

    /// Sum of the displacements of a contact's boats, in cm.
    #[inline]
    fn summed_displacement(&self, contact: &Contact) -> f64 {
        let displacement = |boat: usize| self.displacements[boat];
        displacement(contact.boat as usize) + contact.second().map_or(0.0, displacement)
    }

    /// Whether the boats of contact k move far enough to close it, or to close the other contact of the same two
    /// bodies: a touch may slide from one to the other.
    #[inline]
    pub(super) fn may_close(&self, contacts: &[Contact], k: usize) -> bool {
        let contact = &contacts[k];
        let displacement = self.summed_displacement(contact);
        contact.gap.gap <= displacement
            || contact.has_ends()
                && first_of_two(contacts, k).is_some_and(|first| {
                    contacts[first..first + 2]
                        .iter()
                        .any(|twin| twin.gap.gap <= displacement)
                })
    }

    /// Whether the poses follow from the velocities of the last solve.
    pub(super) fn is_current(&self) -> bool {
        self.is_current
    }

    /// The predicted gap of contact k in cm, at the point to which its touch has moved; infinite if no end faces the
    /// other hull there any more. If two bodies have a single contact, the smaller gap of their touches counts.
    /// `twin_gaps` caches the index of the first of two twin contacts, and the gaps of both.
    #[inline]
    pub(super) fn gap(
        &self,
        detector: &ContactDetector,
        contacts: &[Contact],
        k: usize,
        twin_gaps: &mut Option<(usize, [f64; 2])>,
    ) -> f64 {
        let contact = &contacts[k];
        if !contact.has_ends() || contact.feature.side().is_none() {
            return detector.gap_at(contact, &self.hulls).gap;
        }
        let Some(first) = first_of_two(contacts, k) else {
            return detector.smallest_gap_at(contact, &self.hulls);
        };
        let gaps = match *twin_gaps {
            Some((cached, gaps)) if cached == first => gaps,
            _ => {
                let touches = detector.touches_at(contact, &self.hulls);
                let [stern, bow] = [touches[0].gap, touches[1].gap];
                if are_swapped(&touches, &contacts[first..]) {
                    [bow, stern]
                } else {
                    [stern, bow]
                }
            }
        };
        *twin_gaps = Some((first, gaps));
        gaps[k - first]
    }
}
