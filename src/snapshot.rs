//! Snapshots: a flock's whole state as sealed bytes, to continue from bit for bit. Reading checks the
//! seal and then the state itself.

use crate::boat::{Pose, Velocity};
use crate::contact::Load;
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;
use crate::phase_schedule::Ticks;
use crate::sealed_bytes::{seal, unseal};
use crate::statistics::Statistics;

const MAGIC: [u8; 8] = *b"flockst1";

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
    pub loads: Vec<Load>,
    /// Centres that the neighbour list was built from, and within which distance.
    pub neighbor_reference: (Vec<[f64; 2]>, f64),
    /// Length of the last substep, its phase and the rudders held in it.
    pub last_substep: (Ticks, usize, Option<Vec<f64>>),
    /// Accelerations by lasting contacts.
    pub lasting_acceleration: Vec<[f64; 2]>,
    /// Length of the last kick in s.
    pub kick_s: f64,
    /// Running totals.
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
        unseal::<Self>(MAGIC, bytes)?.checked()
    }

    /// A state that a flock can hold: right sizes, everything finite, indices in range.
    fn checked(self) -> Result<Self> {
        self.parameters.check()?;
        let n = self.parameters.n_boats;
        let (length, phase, rudder) = &self.last_substep;
        let lasting = self.lasting_acceleration.len();
        let reference = self.neighbor_reference.0.len();
        let sizes = self.poses.len() == n
            && self.velocities.len() == n
            && (lasting == 0 || lasting == n)
            && (reference == 0 || reference == n)
            && rudder
                .as_ref()
                .is_none_or(|rudder| rudder.len() == self.parameters.n_leaders)
            && *phase < 4
            && *length <= crate::phase_schedule::ticks(1.0)
            && self
                .loads
                .iter()
                .all(|((boat, _, _), _)| (*boat as usize) < n);
        let plain = self
            .lasting_acceleration
            .iter()
            .chain(&self.neighbor_reference.0)
            .flatten();
        let finite = self.poses.iter().all(Pose::is_in_range)
            && self.velocities.iter().all(Velocity::is_in_range)
            && self.loads.iter().all(|(_, impulse)| impulse.is_finite())
            && rudder.iter().flatten().all(|s| s.abs() <= 1.0)
            && plain
                .chain([&self.kick_s, &self.neighbor_reference.1])
                .all(|value| value.is_finite());
        if sizes && finite && self.time <= crate::flock::LATEST {
            return Ok(self);
        }
        Err(FlockError::Snapshot(
            "the snapshot holds a state that no flock can have".to_owned(),
        ))
    }
}
