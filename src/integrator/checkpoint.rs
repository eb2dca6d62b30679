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
    /// Contacts of the last substep that carried an impulse; a checkpoint before an advance holds the others, too.
    pub warm_start: Vec<CachedImpulse>,
    /// The centers and the distance with which the neighbor list was built.
    pub neighbor_reference: (Vec<Vec2>, f64),
    /// Memory of the leapfrog scheme.
    pub last: LastSubstep,
    /// Speed of water with inertia in cm/s, which a snapshot stores last and only with inertia.
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
    pub(crate) fn save(&self, into: &mut Checkpoint) {
        into.poses.clone_from(&self.poses);
        into.velocities.clone_from(&self.velocities);
        into.last.clone_from(&self.last);
        into.warm_start.clear();
        into.warm_start
            .extend_from_slice(self.contacts.warm_start_impulses());
        let neighbors = &self.contacts.detector.neighbors;
        into.neighbor_reference.0.clear();
        into.neighbor_reference
            .0
            .extend_from_slice(neighbors.reference());
        into.neighbor_reference.1 = neighbors.cutoff();
        into.water_cm_s = self.water_cm_s;
        into.step_length_s = self.step_length_s;
        into.statistics = self.statistics;
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
