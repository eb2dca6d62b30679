//! Snapshots: a flock's whole state as sealed bytes, to continue from bit for bit. Reading checks the
//! seal and then the state itself.

use super::flock::{Flock, LATEST};
use crate::clock::Ticks;
use crate::contact::CachedImpulse;
use crate::error::{FlockError, Result};
use crate::geometry::{Pose, Velocity};
use crate::integrator::Checkpoint;
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
    fn serialize<S: Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        let Self(state) = self;
        let mut parts = to.serialize_tuple(1 + usize::from(state.has_inert_water()))?;
        parts.serialize_element(state)?;
        if state.has_inert_water() {
            parts.serialize_element(&state.motion.water_cm_s)?;
        }
        parts.end()
    }
}

impl<'de> Deserialize<'de> for Stored {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        from.deserialize_tuple(2, Parts).map(Self)
    }
}

/// Reads the parts of a snapshot.
struct Parts;

impl<'de> Visitor<'de> for Parts {
    type Value = Snapshot;

    fn expecting(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        to.write_str("a snapshot")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> std::result::Result<Snapshot, A::Error> {
        let ended = || A::Error::invalid_length(0, &self);
        let mut state: Snapshot = parts.next_element()?.ok_or_else(ended)?;
        if state.has_inert_water() {
            state.motion.water_cm_s = parts.next_element()?.ok_or_else(ended)?;
        }
        Ok(state)
    }
}

impl Snapshot {
    fn has_inert_water(&self) -> bool {
        self.parameters.current_relaxation_s > 0.0
    }

    /// The flock's parameters with the step that it was made with.
    fn as_made(&self) -> FlockParameters {
        FlockParameters {
            dt_s: self.noise_dt_s,
            ..self.parameters.clone()
        }
    }

    /// A state that a flock can hold: right sizes, everything finite, indices in range.
    fn checked(self) -> Result<Self> {
        self.parameters.check()?;
        self.as_made().check()?;
        let n = self.parameters.n_boats;
        let motion = &self.motion;
        let last = &motion.last;
        let (reference, cutoff) = &motion.neighbor_reference;
        let none_or_all = |vectors: usize| vectors == 0 || vectors == n;
        let sizes = motion.poses.len() == n
            && motion.velocities.len() == n
            && none_or_all(last.persistent_acceleration.len())
            && none_or_all(reference.len())
            && last
                .rudder
                .as_ref()
                .is_none_or(|rudder| rudder.len() == self.parameters.n_leaders)
            && last.phase < 4
            && last.length <= crate::clock::ticks(1.0)
            && motion
                .warm_start
                .iter()
                .all(|entry| (entry.boat as usize) < n);
        let vectors = last.persistent_acceleration.iter().chain(reference);
        let finite = motion.poses.iter().all(Pose::is_in_range)
            && motion.velocities.iter().all(Velocity::is_in_range)
            && motion.warm_start.iter().all(CachedImpulse::is_finite)
            && last.rudder.iter().flatten().all(|s| s.abs() <= 1.0)
            && motion.water_cm_s.abs() <= self.parameters.current_cap_cm_s
            && vectors
                .flatten()
                .chain([&motion.step_length_s, cutoff])
                .all(|value| value.is_finite());
        let why = "the snapshot holds a state that no flock can have";
        FlockError::unless_fitting(sizes && finite && self.time <= LATEST, why)?;
        Ok(self)
    }
}

/// Stores a flock like its snapshot, but without a seal: whatever contains it is sealed.
impl Serialize for Flock {
    fn serialize<S: Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        Stored(self.state()).serialize(to)
    }
}

impl<'de> Deserialize<'de> for Flock {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        let state = Stored::deserialize(from)?.0.checked();
        let state = state.map_err(|error| match error {
            FlockError::Snapshot(why) => refused(why),
            other => refused(other.to_string()),
        })?;
        Ok(Self::from_checked(state, None))
    }
}

impl Flock {
    /// The whole state as bytes.
    pub fn snapshot(&self) -> Vec<u8> {
        seal(&MAGIC, &Stored(self.state()))
    }

    fn state(&self) -> Snapshot {
        Snapshot {
            parameters: self.parameters.clone(),
            seed: self.seed,
            noise_seed: self.noise_seed(),
            time: self.time,
            noise_dt_s: self.noise_dt_s,
            motion: self.integrator.checkpoint(),
        }
    }

    /// The flock of a checked state.
    fn from_checked(state: Snapshot, noise_seed: Option<u64>) -> Self {
        let mut flock = Self::unplaced(state.as_made(), state.seed);
        flock.replace_step(state.parameters.dt_s);
        flock.time = state.time;
        flock.integrator.return_to(&state.motion);
        flock.branch(noise_seed.or(state.noise_seed));
        flock
    }

    /// Continues from a snapshot of a flock with the same parameters (except for the target, which the snapshot holds),
    /// with the noise of the snapshot or that of another seed.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`]; the flock is unchanged then.
    pub fn restore(&mut self, bytes: &[u8], noise_seed: Option<u64>) -> Result<()> {
        let restored = Self::from_snapshot(bytes, noise_seed)?;
        let same = FlockParameters {
            target: self.parameters.target.clone(),
            ..restored.parameters.clone()
        };
        let why = "the snapshot's flock has other parameters";
        FlockError::unless_fitting(same == self.parameters, why)?;
        *self = restored;
        Ok(())
    }

    /// A flock from a snapshot alone, with the noise of the snapshot or that of another seed. The same noise seed
    /// gives all flocks the same noise.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged snapshot.
    pub fn from_snapshot(bytes: &[u8], noise_seed: Option<u64>) -> Result<Self> {
        let state = unseal::<Stored>(&MAGIC, bytes)?.0.checked()?;
        Ok(Self::from_checked(state, noise_seed))
    }
}
