//! Complete state of the motion, saved before every advance and stored in snapshots.

use super::state::Integrator;
use super::substep::LastSubstep;
use crate::contact::{CachedImpulse, Statistics};
use crate::geometry::{Pose, Vec2, Velocity};

/// The complete state of the motion, apart from parameters, seed and time.
/// Snapshots store the fields in this order.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Checkpoint {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
    /// Contacts of the last substep that carried an impulse. A checkpoint saved before an advance also holds the others.
    pub warm_start: Vec<CachedImpulse>,
    /// The centers and the distance with which the neighbor list was built.
    pub neighbor_reference: (Vec<Vec2>, f64),
    /// Memory of the leapfrog scheme.
    pub last: LastSubstep,
    /// Speed in cm/s of water with inertia. A snapshot stores it after the other fields, and only if the water has
    /// inertia.
    #[serde(skip)]
    pub water_cm_s: f64,
    /// Time in s by which impulses are divided to give forces.
    pub step_length_s: f64,
    /// Running statistics.
    pub statistics: Statistics,
}

impl Integrator {
    /// A copy of the present motion.
    pub(crate) fn checkpoint(&self) -> Checkpoint {
        let mut checkpoint = Checkpoint::default();
        self.save(&mut checkpoint);
        checkpoint.warm_start.retain(|entry| entry.impulse > 0.0);
        checkpoint
    }

    /// Overwrites a checkpoint with the present motion, and reuses its memory.
    pub(crate) fn save(&self, checkpoint: &mut Checkpoint) {
        checkpoint.poses.clone_from(&self.poses);
        checkpoint.velocities.clone_from(&self.velocities);
        checkpoint.last.clone_from(&self.last);
        checkpoint.warm_start.clear();
        checkpoint
            .warm_start
            .extend_from_slice(self.contacts.warm_start_impulses());
        let neighbors = &self.contacts.detector.neighbors;
        let (reference, cutoff) = &mut checkpoint.neighbor_reference;
        reference.clear();
        reference.extend_from_slice(neighbors.reference());
        *cutoff = neighbors.cutoff();
        checkpoint.water_cm_s = self.water_cm_s;
        checkpoint.step_length_s = self.step_length_s;
        checkpoint.statistics = self.statistics;
    }

    /// Continues from a checkpoint, bit for bit.
    pub(crate) fn return_to(&mut self, checkpoint: &Checkpoint) {
        self.place(&checkpoint.poses, &checkpoint.velocities);
        self.last.clone_from(&checkpoint.last);
        self.contacts.set_warm_start(&checkpoint.warm_start);
        let (reference, cutoff) = &checkpoint.neighbor_reference;
        self.contacts.detector.neighbors.restore(reference, *cutoff);
        self.water_cm_s = checkpoint.water_cm_s;
        self.step_length_s = checkpoint.step_length_s;
        self.statistics = checkpoint.statistics;
    }
}
