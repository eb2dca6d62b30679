//! A training that the page continues, some branches at a time.

use crate::request::{Request, Written, set_given};
use flockenv::environment::ActionMode;
use flockenv::parameters::Physics;
use flockenv::training::{BranchSettings, Trainer};
use flockenv::{FlockError, Result};
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// The first seed of trainings by branches, and the seeds of one training, as in `flockenv/runs/seeds.py`.
const SEEDS: (u64, u64) = ((1 << 32) + (6 << 56), 1 << 24);
/// Seeds of trainings.
const RUNS: u64 = 1 << 32;

/// A request for a training: the flock with the training's seed, settings by name, and texts for the policy.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    flock: Written,
    options: Map<String, Json>,
    provenance: BTreeMap<String, String>,
}

/// Leaders that learn from nothing to choose rudders.
pub(crate) struct Training {
    trainer: Trainer,
    provenance: BTreeMap<String, String>,
}

impl Training {
    /// A training from its start, with the physics of trainings.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn new(text: &str) -> Result<Self> {
        let asked: Asked = serde_json::from_str(text)
            .map_err(|error| FlockError::parameter("training", error, "JSON"))?;
        let Request {
            mut parameters,
            seed,
            ..
        } = Request::checked(asked.flock)?;
        if let Some((dt_s, tolerance_cm)) = Physics::Training.stepping() {
            (parameters.dt_s, parameters.tolerance_cm) = (dt_s, tolerance_cm);
        }
        if seed >= RUNS {
            return Err(FlockError::parameter("seed", seed, "0 to 2^32 - 1"));
        }
        let mut settings = BranchSettings::usual(ActionMode::Rudder);
        set_given(&mut settings, BranchSettings::FIELDS, &asked.options)?;
        let first = SEEDS.0 + SEEDS.1 * seed;
        Ok(Self {
            trainer: Trainer::new(settings, parameters, seed, first)?,
            provenance: asked.provenance,
        })
    }

    /// Takes one more branch.
    ///
    /// # Errors
    /// As for [`Trainer::advance`].
    pub fn advance(&mut self) -> Result<()> {
        self.trainer.advance(&|| true, 1)
    }

    /// Flock-hours so far and at the end, whether the end is reached, the flocks' physics, and the present policy as a
    /// file's text.
    ///
    /// # Errors
    /// As for [`Trainer::law`].
    pub fn said(&self) -> Result<Json> {
        let (parameters, (hours, end)) = (self.trainer.parameters(), self.trainer.flock_hours());
        let mut law = self.trainer.law()?;
        law.provenance = self.provenance.clone();
        let done = ("flock_hours".to_owned(), hours.to_string());
        law.provenance.extend([done]);
        Ok(json!({
            "hours": hours,
            "end": end,
            "has_ended": self.trainer.has_ended(),
            "physics": { "dt_s": parameters.dt_s, "tolerance_cm": parameters.tolerance_cm },
            "policy": law.to_json()?,
        }))
    }
}
