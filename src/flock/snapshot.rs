//! Snapshots: a flock's whole state as bytes with a checksum. A restored flock continues bit for bit. Reading checks the
//! bytes, and then the state in them.

use super::flock::{Flock, LATEST};
use crate::clock::{Ticks, ticks};
use crate::contact::CachedImpulse;
use crate::error::{FlockError, Result};
use crate::geometry::{Pose, Velocity};
use crate::integrator::{Checkpoint, Phase};
use crate::parameters::FlockParameters;
use crate::sealed_bytes::{Magic, refused, seal, unseal};
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

const MAGIC: Magic = *b"flockst4";

/// Content of a snapshot.
#[derive(Debug, Serialize, Deserialize)]
struct Snapshot {
    parameters: FlockParameters,
    seed: u64,
    noise_seed: Option<u64>,
    time: Ticks,
    noise_dt_s: f64,
    motion: Checkpoint,
}

/// The byte layout of a snapshot. The speed of the water comes last, and only if the water has inertia.
struct Stored(Snapshot);

impl Serialize for Stored {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let Self(state) = self;
        let parts_count = 1 + usize::from(state.has_inert_water());
        let mut parts = serializer.serialize_tuple(parts_count)?;
        parts.serialize_element(state)?;
        if state.has_inert_water() {
            parts.serialize_element(&state.motion.water_cm_s)?;
        }
        parts.end()
    }
}

impl<'de> Deserialize<'de> for Stored {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let most_parts = 2;
        let snapshot = deserializer.deserialize_tuple(most_parts, StoredVisitor);
        snapshot.map(Self)
    }
}

/// Reads a snapshot and, if the water has inertia, its speed.
struct StoredVisitor;

impl<'de> Visitor<'de> for StoredVisitor {
    type Value = Snapshot;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("a snapshot")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> std::result::Result<Snapshot, A::Error> {
        let too_short = || A::Error::invalid_length(0, &self);
        let mut state: Snapshot = parts.next_element()?.ok_or_else(too_short)?;
        if state.has_inert_water() {
            state.motion.water_cm_s = parts.next_element()?.ok_or_else(too_short)?;
        }
        Ok(state)
    }
}

impl Snapshot {
    fn has_inert_water(&self) -> bool {
        self.parameters.current_relaxation_s > 0.0
    }

    /// The flock's parameters with the `dt_s` that it was made with.
    fn parameters_as_made(&self) -> FlockParameters {
        FlockParameters {
            dt_s: self.noise_dt_s,
            ..self.parameters.clone()
        }
    }

    /// Returns the snapshot if a flock can have its state.
    fn checked(self) -> Result<Self> {
        self.parameters.check()?;
        self.parameters_as_made().check()?;
        let why = "the snapshot holds a state that no flock can have";
        FlockError::unless_fitting(self.has_right_sizes() && self.is_in_range(), why)?;
        Ok(self)
    }

    /// Whether lengths and indices fit the flock's numbers of boats and leaders.
    fn has_right_sizes(&self) -> bool {
        let (n, motion) = (self.parameters.n_boats, &self.motion);
        let last = &motion.last;
        let (neighbor_reference, _) = &motion.neighbor_reference;
        let is_zero_or_n = |length: usize| length == 0 || length == n;
        let fits_leaders = |rudder: &Vec<f64>| rudder.len() == self.parameters.n_leaders;
        let mut warm_start = motion.warm_start.iter();
        motion.poses.len() == n
            && motion.velocities.len() == n
            && is_zero_or_n(last.persistent_acceleration.len())
            && is_zero_or_n(neighbor_reference.len())
            && last.rudder.as_ref().is_none_or(fits_leaders)
            && warm_start.all(|entry| (entry.boat as usize) < n)
    }

    /// Whether all numbers are finite and in the range of a flock's numbers.
    fn is_in_range(&self) -> bool {
        let motion = &self.motion;
        let last = &motion.last;
        let (neighbor_reference, cutoff) = &motion.neighbor_reference;
        let vectors = last.persistent_acceleration.iter();
        let mut numbers = vectors
            .chain(neighbor_reference)
            .flatten()
            .chain([&motion.step_length_s, cutoff]);
        let mut rudders = last.rudder.iter().flatten();
        let longest_substep = ticks(1.0);
        self.time <= LATEST
            && last.phase < Phase::ALL.len()
            && last.length <= longest_substep
            && motion.poses.iter().all(Pose::is_in_range)
            && motion.velocities.iter().all(Velocity::is_in_range)
            && motion.warm_start.iter().all(CachedImpulse::is_finite)
            && rudders.all(|rudder| rudder.abs() <= 1.0)
            && motion.water_cm_s.abs() <= self.parameters.current_cap_cm_s
            && numbers.all(|number| number.is_finite())
    }
}

/// Stores a flock as in its snapshot, but without a checksum. The bytes around it have a checksum.
impl Serialize for Flock {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Stored(self.snapshot_content()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Flock {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let Stored(snapshot) = Stored::deserialize(deserializer)?;
        let state = snapshot.checked().map_err(|error| match error {
            FlockError::Snapshot(why) => refused(why),
            other => refused(other.to_string()),
        })?;
        let own_noise = None;
        Ok(Self::from_checked(state, own_noise))
    }
}

impl Flock {
    /// The whole state as bytes.
    pub fn snapshot(&self) -> Vec<u8> {
        seal(&MAGIC, &Stored(self.snapshot_content()))
    }

    fn snapshot_content(&self) -> Snapshot {
        Snapshot {
            parameters: self.parameters.clone(),
            seed: self.seed,
            noise_seed: self.noise_seed(),
            time: self.time,
            noise_dt_s: self.noise_dt_s,
            motion: self.integrator.checkpoint(),
        }
    }

    /// A flock from a checked snapshot. It continues with the noise of `noise_seed`; `None`: with the snapshot's noise.
    fn from_checked(state: Snapshot, noise_seed: Option<u64>) -> Self {
        let mut flock = Self::unplaced(state.parameters_as_made(), state.seed);
        flock.replace_step(state.parameters.dt_s);
        flock.time = state.time;
        flock.integrator.return_to(&state.motion);
        flock.branch(noise_seed.or(state.noise_seed));
        flock
    }

    /// Continues from a snapshot, with the noise of `noise_seed`; `None`: with the snapshot's noise. The snapshot's flock
    /// must have the same parameters, except for the target, which is restored.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`]; the flock is unchanged then.
    pub fn restore(&mut self, bytes: &[u8], noise_seed: Option<u64>) -> Result<()> {
        let restored = Self::from_snapshot(bytes, noise_seed)?;
        let expected = FlockParameters {
            target: restored.parameters.target.clone(),
            ..self.parameters.clone()
        };
        let why = "the snapshot's flock has other parameters";
        FlockError::unless_fitting(restored.parameters == expected, why)?;
        *self = restored;
        Ok(())
    }

    /// A flock from a snapshot alone, with the noise of `noise_seed`; `None`: with the snapshot's noise. All flocks with
    /// the same noise seed get the same noise.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged snapshot.
    pub fn from_snapshot(bytes: &[u8], noise_seed: Option<u64>) -> Result<Self> {
        let Stored(snapshot) = unseal(&MAGIC, bytes)?;
        Ok(Self::from_checked(snapshot.checked()?, noise_seed))
    }
}
