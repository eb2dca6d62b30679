//! Small scenes and a shorthand for steps.

use flockenv::Flock;
use flockenv::environment::{BatchRows, EnvBatch, EnvSettings, ResetRequest};
use flockenv::parameters::{FlockParameters, Pool, Preset};

/// Nine boats in the small pool.
pub fn parameters(n_leaders: usize) -> FlockParameters {
    FlockParameters {
        n_boats: 9,
        n_leaders,
        pool: Pool::NARROW,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

/// Settings of episodes of so many control steps.
pub fn settings(steps: u32) -> EnvSettings {
    EnvSettings {
        episode_s: Some(f64::from(steps) / 10.0),
        ..EnvSettings::default()
    }
}

/// Settings, parameters or a request with something changed.
pub fn changed<T>(mut of: T, change: impl FnOnce(&mut T)) -> T {
    change(&mut of);
    of
}

/// A request with a seed.
pub fn seeded(seed: u64) -> Option<ResetRequest> {
    Some(requested(|request| request.seed = Some(seed)))
}

/// A request for what is changed in it.
pub fn requested(change: impl FnOnce(&mut ResetRequest)) -> ResetRequest {
    changed(ResetRequest::default(), change)
}

/// A flock of a batch, in its episode.
pub fn flock(batch: &EnvBatch, place: usize) -> &Flock {
    batch.envs()[place].episode().unwrap().flock()
}

/// A batch of flocks with these numbers of leaders, seeded one after another.
pub fn batch(settings: EnvSettings, leaders: &[usize], first_seed: u64) -> EnvBatch {
    let members = leaders.iter().map(|&k| parameters(k)).collect();
    let mut batch = EnvBatch::new(settings, members).unwrap();
    let seeds = first_seed..first_seed + leaders.len() as u64;
    batch.reset(&seeds.map(seeded).collect::<Vec<_>>()).unwrap();
    batch
}

/// What a step wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    pub observations: Vec<f32>,
    pub rewards: Vec<f64>,
    pub truncated: Vec<bool>,
}

/// Steps and returns what was written.
pub fn step(batch: &mut EnvBatch, actions: &[f64]) -> flockenv::Result<Written> {
    step_by(batch, Some(actions))
}

/// As [`step`]; without actions leaders follow the steering law.
pub fn step_by(batch: &mut EnvBatch, actions: Option<&[f64]>) -> flockenv::Result<Written> {
    let mut written = Written {
        observations: vec![f32::NAN; batch.rows() * batch.observation_size()],
        rewards: vec![f64::NAN; batch.rows()],
        truncated: vec![false; batch.envs().len()],
    };
    let rows = BatchRows {
        observations: &mut written.observations,
        rewards: &mut written.rewards,
        truncated: &mut written.truncated,
    };
    batch.step(actions, rows)?;
    Ok(written)
}
