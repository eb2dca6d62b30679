//! A training that the page advances by some branches at a time.

use crate::request::{Request, RequestFields, set_fields};
use flockenv::environment::ActionMode;
use flockenv::parameters::Physics;
use flockenv::training::{BranchSettings, Trainer};
use flockenv::{FlockError, Result};
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// The first seed of flocks that trainings by branches use, as in `flockenv/runs/seeds.py`.
const FIRST_SEED: u64 = (1 << 32) + (6 << 56);
/// Number of seeds of flocks for one training.
const SEEDS_PER_TRAINING: u64 = 1 << 24;
/// Number of seeds of trainings.
const TRAININGS: u64 = 1 << 32;

/// A request for a training: the flock with the training's seed, settings by name, and the provenance of the policy.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TrainingRequest {
    flock: RequestFields,
    options: Map<String, Json>,
    provenance: BTreeMap<String, String>,
}

/// Leaders that learn to choose rudders, starting from weights of 0.
pub(crate) struct Training {
    trainer: Trainer,
    provenance: BTreeMap<String, String>,
}

impl Training {
    /// Starts a training from a request in JSON, with the physics `training`.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn new(text: &str) -> Result<Self> {
        let request: TrainingRequest = serde_json::from_str(text)
            .map_err(|error| FlockError::parameter("training", error, "JSON"))?;
        let Request {
            mut parameters,
            seed,
            ..
        } = Request::checked(request.flock)?;
        if let Some((dt_s, tolerance_cm)) = Physics::Training.stepping() {
            (parameters.dt_s, parameters.tolerance_cm) = (dt_s, tolerance_cm);
        }
        if seed >= TRAININGS {
            return Err(FlockError::parameter("seed", seed, "0 to 2^32 - 1"));
        }
        let mut settings = BranchSettings::usual(ActionMode::Rudder);
        set_fields(&mut settings, BranchSettings::FIELDS, &request.options)?;
        let first_seed = FIRST_SEED + SEEDS_PER_TRAINING * seed;
        Ok(Self {
            trainer: Trainer::new(settings, parameters, seed, first_seed)?,
            provenance: request.provenance,
        })
    }

    /// Simulates one more branch.
    ///
    /// # Errors
    /// As for [`Trainer::advance`].
    pub fn advance(&mut self) -> Result<()> {
        self.trainer.advance(&|| true, 1)
    }

    /// Flock-hours so far and at the end, whether the training has ended, the flocks' physics, and the present policy as the
    /// text of its file.
    ///
    /// # Errors
    /// As for [`Trainer::law`].
    pub fn progress(&self) -> Result<Json> {
        let (parameters, (hours, end)) = (self.trainer.parameters(), self.trainer.flock_hours());
        let mut law = self.trainer.law()?;
        law.provenance = self.provenance.clone();
        law.provenance
            .insert("flock_hours".to_owned(), hours.to_string());
        Ok(json!({
            "hours": hours,
            "end": end,
            "has_ended": self.trainer.has_ended(),
            "physics": { "dt_s": parameters.dt_s, "tolerance_cm": parameters.tolerance_cm },
            "policy": law.to_json()?,
        }))
    }
}
