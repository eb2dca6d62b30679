//! Snapshots: a flock's whole state as sealed bytes, to continue from bit for bit. Reading checks the
//! seal and then the state itself.

use super::flock::{Flock, LATEST};
use crate::clock::Ticks;
use crate::contact::{CachedImpulse, Statistics};
use crate::error::{FlockError, Result};
use crate::geometry::{Pose, Vec2, Velocity};
use crate::integrator::{Checkpoint, LastSubstep};
use crate::parameters::FlockParameters;
use crate::sealed_bytes::{decode, opened, seal, unseal};

const MAGIC: [u8; 8] = *b"flockst2";
/// Of snapshots that end one number earlier: at the statistics' worst overlap.
const MAGIC_1: [u8; 8] = *b"flockst1";

/// What a snapshot holds.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Snapshot {
    /// Parameters of the flock.
    pub parameters: FlockParameters,
    /// Its seed.
    pub seed: u64,
    /// Its time.
    pub time: Ticks,
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
    /// Contacts that carried an impulse in the last substep.
    pub warm_start: Vec<CachedImpulse>,
    /// Centers that the neighbor list was built from, and within which distance.
    pub neighbor_reference: (Vec<[f64; 2]>, f64),
    /// Length of the last substep, its phase and the rudders held in it.
    pub last_substep: (Ticks, usize, Option<Vec<f64>>),
    /// Accelerations by persistent contacts.
    pub persistent_acceleration: Vec<[f64; 2]>,
    /// What impulses are divided by to give forces, in s.
    pub step_length_s: f64,
    /// Running statistics.
    pub statistics: Statistics,
}

impl Snapshot {
    /// The snapshot as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        seal(MAGIC, self)
    }

    /// Reads a snapshot.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a whole, unharmed snapshot of this version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        if bytes.starts_with(&MAGIC_1) {
            let body = opened(MAGIC_1, bytes)?;
            return decode::<Self>(&[body, &0_f64.to_le_bytes()].concat())?.checked();
        }
        unseal::<Self>(MAGIC, bytes)?.checked()
    }

    /// A state that a flock can hold: right sizes, everything finite, indices in range.
    fn checked(self) -> Result<Self> {
        self.parameters.check()?;
        let n = self.parameters.n_boats;
        let (length, phase, rudder) = &self.last_substep;
        let accelerated = self.persistent_acceleration.len();
        let reference = self.neighbor_reference.0.len();
        let sizes = self.poses.len() == n
            && self.velocities.len() == n
            && (accelerated == 0 || accelerated == n)
            && (reference == 0 || reference == n)
            && rudder
                .as_ref()
                .is_none_or(|rudder| rudder.len() == self.parameters.n_leaders)
            && *phase < 4
            && *length <= crate::clock::ticks(1.0)
            && self
                .warm_start
                .iter()
                .all(|((boat, _, _), _)| (*boat as usize) < n);
        let plain = self
            .persistent_acceleration
            .iter()
            .chain(&self.neighbor_reference.0)
            .flatten();
        let finite = self.poses.iter().all(Pose::is_in_range)
            && self.velocities.iter().all(Velocity::is_in_range)
            && self
                .warm_start
                .iter()
                .all(|(_, impulse)| impulse.is_finite())
            && rudder.iter().flatten().all(|s| s.abs() <= 1.0)
            && plain
                .chain([&self.step_length_s, &self.neighbor_reference.1])
                .all(|value| value.is_finite());
        if sizes && finite && self.time <= LATEST {
            return Ok(self);
        }
        Err(FlockError::Snapshot(
            "the snapshot holds a state that no flock can have".to_owned(),
        ))
    }
}

impl Flock {
    /// The whole state as bytes.
    pub fn snapshot(&self) -> Vec<u8> {
        let state = self.integrator.checkpoint();
        let pairs = |vectors: &[Vec2]| vectors.iter().map(|v| [v.x, v.y]).collect::<Vec<_>>();
        let (reference, cutoff) = &state.neighbor_reference;
        Snapshot {
            parameters: self.parameters.clone(),
            seed: self.seed,
            time: self.time,
            neighbor_reference: (pairs(reference), *cutoff),
            last_substep: (state.last.length, state.last.phase, state.last.rudder),
            persistent_acceleration: pairs(&state.last.persistent_acceleration),
            poses: state.poses,
            velocities: state.velocities,
            warm_start: state.warm_start,
            step_length_s: state.step_length_s,
            statistics: state.statistics,
        }
        .to_bytes()
    }

    /// Continues from a snapshot of a flock with the same parameters (the target aside, which the
    /// snapshot brings along).
    ///
    /// # Errors
    /// [`FlockError::Snapshot`]; the flock is unchanged then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<()> {
        let restored = Self::from_snapshot(bytes)?;
        let same = FlockParameters {
            target: self.parameters.target,
            ..restored.parameters.clone()
        };
        if same != self.parameters {
            return Err(FlockError::Snapshot(
                "the snapshot is of a flock with other parameters".to_owned(),
            ));
        }
        *self = restored;
        Ok(())
    }

    /// A flock from a snapshot alone.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a whole, unharmed snapshot.
    pub fn from_snapshot(bytes: &[u8]) -> Result<Self> {
        let snapshot = Snapshot::from_bytes(bytes)?;
        let vectors = |pairs: Vec<[f64; 2]>| {
            pairs
                .into_iter()
                .map(|[x, y]| Vec2::new(x, y))
                .collect::<Vec<_>>()
        };
        let mut flock = Self::unplaced(snapshot.parameters, snapshot.seed);
        flock.time = snapshot.time;
        let (reference, cutoff) = snapshot.neighbor_reference;
        let (length, phase, rudder) = snapshot.last_substep;
        flock.integrator.return_to(&Checkpoint {
            poses: snapshot.poses,
            velocities: snapshot.velocities,
            last: LastSubstep {
                length,
                phase,
                rudder,
                persistent_acceleration: vectors(snapshot.persistent_acceleration),
            },
            warm_start: snapshot.warm_start,
            neighbor_reference: (vectors(reference), cutoff),
            step_length_s: snapshot.step_length_s,
            statistics: snapshot.statistics,
        });
        Ok(flock)
    }
}
