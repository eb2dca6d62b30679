//! The scenes that everything is measured on.

use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::{Pool, Preset};
use flockenv::{Flock, FlockParameters};

/// The start of a run.
#[derive(Debug, Clone)]
pub struct Start {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Their velocities.
    pub velocities: Vec<Velocity>,
    /// Time in s, which sets where in the cycle of phases the run starts.
    pub time_s: f64,
}

impl Start {
    /// The random placement of a seed, at rest: the same for every engine.
    ///
    /// # Panics
    /// If the boats do not fit.
    pub fn placed(parameters: &FlockParameters, seed: u64) -> Self {
        Self::from_flock(&Flock::new(parameters.clone(), seed).expect("the boats fit"))
    }

    /// The present state of a flock.
    pub fn from_flock(flock: &Flock) -> Self {
        Self {
            poses: flock.poses().to_vec(),
            velocities: flock.velocities().to_vec(),
            time_s: flock.time_s(),
        }
    }
}

/// A scene: what the motors do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scene {
    /// Motors always forward: the flock presses against the outer wall.
    Jam,
    /// Phases of [2 1 2 1] s.
    Cycle,
}

impl Scene {
    /// Both scenes.
    pub const ALL: [Self; 2] = [Self::Jam, Self::Cycle];
    /// Length of a cycle of phases in s, and of the blocks of a jam that are timed.
    pub const BLOCK_S: f64 = 6.0;

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Jam => "jam",
            Self::Cycle => "cycle",
        }
    }

    /// Leaderless boats in pool `narrow`, scaled by sqrt(n/50) beyond 50.
    pub fn parameters(self, boats: usize) -> FlockParameters {
        let scale = (boats as f64 / 50.0).sqrt().max(1.0);
        let off_s = match self {
            Self::Jam => 0.0,
            Self::Cycle => 1.0,
        };
        FlockParameters {
            n_boats: boats,
            pool: Pool {
                outer_radius_cm: Pool::NARROW.outer_radius_cm * scale,
                inner_radius_cm: Pool::NARROW.inner_radius_cm * scale,
            },
            fw_s: 2.0,
            nop1_s: off_s,
            bw_s: 2.0 * off_s,
            nop2_s: off_s,
            ..FlockParameters::preset(Preset::Simulation)
        }
    }
}
