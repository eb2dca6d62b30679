//! The leaning law: a heading that leans outward of the target's tangent, or a rudder, as a bounded linear function of a
//! leader's observation.

use crate::boat::DampedLaw;
use crate::environment::LARGEST_LEAN;
use crate::environment::observation::{LEAN_FEATURES, LeanFeatures};
use crate::error::{FlockError, Result};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

/// How an action is kept in [−1, 1], where 1 is a lean of [`LARGEST_LEAN`] or the full rudder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// By a hyperbolic tangent.
    Tanh,
    /// By clipping.
    Clip,
}

/// The order that a law reached when it was judged, and in which flocks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judged {
    /// Mean signed order of the flocks.
    pub signed_order: f64,
    /// 95 % interval of that mean.
    pub interval: [f64; 2],
    /// Boats of each flock, leaders included.
    pub n_boats: usize,
    /// Leaders of each flock.
    pub n_leaders: usize,
    /// Backward duration in s.
    pub bw_s: f64,
    /// Length of an episode in s.
    pub episode_s: f64,
    /// First and last seed, one for each flock.
    pub seeds: [u64; 2],
}

/// The damped law about a heading that leans outward of the target's tangent: by bias + Σ weight·feature in rad, where
/// the features are the standardized lean features. Without gains the sum is the rudder itself, for a clockwise target.
///
/// It is stored as JSON, with each weight under the name of its feature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaningLaw {
    #[serde(deserialize_with = "known_format")]
    format: u32,
    /// Name of the pool whose usual values standardize the features.
    pub pool: String,
    /// The order that the law reached when it was judged, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub judged: Option<Judged>,
    /// The damped law that steers to the heading; `None`: leaders choose rudders. A file must hold `gains`, if only as
    /// `null`.
    #[serde(deserialize_with = "Option::deserialize")]
    pub gains: Option<DampedLaw>,
    /// How the action is kept in [−1, 1].
    pub bound: Bound,
    /// Time in s for which a lean or a rudder is held, a whole number of control steps; `None`: one control step. If
    /// leans are held, the gains must be those tuned in the pool, as for the action mode "lean".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decision_period_s: Option<f64>,
    /// Lean in rad, or rudder, if every feature has its usual value.
    pub bias: f64,
    /// Rad, or rudder, per standard deviation of each feature.
    #[serde(with = "by_feature")]
    pub weights: [f64; LEAN_FEATURES],
    /// The law's provenance: short texts by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub provenance: BTreeMap<String, String>,
}

/// The only format so far.
const FORMAT: u32 = 1;

fn known_format<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<u32, D::Error> {
    match u32::deserialize(deserializer)? {
        FORMAT => Ok(FORMAT),
        other => Err(serde::de::Error::custom(format!(
            "format = {other} is not accepted: this version of flockenv reads format {FORMAT}"
        ))),
    }
}

/// Weights by the names of their features.
mod by_feature {
    use super::*;
    use serde::de::Error;
    use serde::ser::SerializeMap;

    pub(super) fn serialize<S: Serializer>(
        weights: &[f64; LEAN_FEATURES],
        serializer: S,
    ) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(LEAN_FEATURES))?;
        for (name, weight) in LeanFeatures::names().zip(weights) {
            map.serialize_entry(name, weight)?;
        }
        map.end()
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> std::result::Result<[f64; LEAN_FEATURES], D::Error> {
        let mut by_name = BTreeMap::<String, f64>::deserialize(deserializer)?;
        let mut weights = [0.0; LEAN_FEATURES];
        for (weight, name) in weights.iter_mut().zip(LeanFeatures::names()) {
            let stored = by_name.remove(name);
            let missing =
                || D::Error::custom(format!("weights lack {name}: each lean feature needs one"));
            *weight = stored.ok_or_else(missing)?;
        }
        match by_name.pop_first() {
            None => Ok(weights),
            Some((name, _)) => Err(D::Error::custom(format!(
                "weights have {name:?}, which is no lean feature: {}",
                LeanFeatures::names().collect::<Vec<_>>().join(", ")
            ))),
        }
    }
}

/// The pretrained leaders by the name of their pool. The rule of `baselines/pretrained.py` chose them. Source:
/// `studies/trainings`, results version 5.
const LEARNED: [(&str, &str); 1] = [("wide", include_str!("learned/wide.json"))];

impl LeaningLaw {
    /// A law with these numbers: the weights of the features, then the bias.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for what [`Self::check`] refuses.
    pub fn new(
        pool: Option<&str>,
        gains: Option<DampedLaw>,
        decision_period_s: Option<f64>,
        numbers: &[f64; LEAN_FEATURES + 1],
    ) -> Result<Self> {
        LeanFeatures::check_pool(pool)?;
        let law = Self {
            format: FORMAT,
            pool: pool.unwrap_or_default().to_owned(),
            judged: None,
            gains,
            bound: Bound::Tanh,
            decision_period_s,
            bias: numbers[LEAN_FEATURES],
            weights: std::array::from_fn(|index| numbers[index]),
            provenance: BTreeMap::new(),
        };
        law.check()?;
        Ok(law)
    }

    /// The law in a JSON text.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for text that is not a law, and for laws that [`Self::check`] refuses.
    pub fn from_json(text: &str) -> Result<Self> {
        let law: Self = serde_json::from_str(text).map_err(|error| {
            FlockError::parameter("policy", error, "a leaning law in JSON of finite numbers")
        })?;
        law.check()?;
        Ok(law)
    }

    /// The law as a JSON text, from which [`Self::from_json`] restores it bit for bit.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for laws that [`Self::check`] refuses.
    pub fn to_json(&self) -> Result<String> {
        self.check()?;
        let text = serde_json::to_string_pretty(self);
        text.map_err(|error| FlockError::parameter("policy", error, "what JSON can hold"))
    }

    /// The pretrained leaders of the pool with this name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for pools without pretrained leaders.
    pub fn learned(pool: Option<&str>) -> Result<Self> {
        let entry = LEARNED.iter().find(|(name, _)| Some(*name) == pool);
        let (_, text) = entry.ok_or_else(|| {
            let pools = LEARNED.map(|(name, _)| name).join(" and ");
            let accepted = format!(
                "learned leaders are for {pools}: in narrow none led better than the tuned law"
            );
            FlockError::parameter("pool", pool.unwrap_or("without a name"), accepted)
        })?;
        Self::from_json(text)
    }

    /// Checks the law's numbers.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for numbers out of range, for pools whose features are not standardized, and if leans are
    /// held with gains other than those tuned in the pool.
    pub fn check(&self) -> Result<()> {
        self.gains.map_or(Ok(()), |gains| gains.check())?;
        LeanFeatures::check_pool(Some(&self.pool))?;
        let weights = LeanFeatures::names().zip(self.weights);
        for (name, value) in weights.chain([("bias", self.bias)]) {
            FlockError::unless(
                value.abs() <= 1e9,
                name,
                value,
                "a finite number from -1e9 to 1e9",
            )?;
        }
        let Some(period) = self.decision_period_s else {
            return Ok(());
        };
        let is_tuned = self
            .gains
            .is_none_or(|gains| DampedLaw::TUNED.contains(&(self.pool.as_str(), gains)));
        let accepted = "none, unless the gains are the tuned ones of the pool";
        FlockError::unless(is_tuned, "decision_period_s", period, accepted)?;
        let is_time = period > 0.0 && period <= 1e6;
        let accepted = "a positive time in s, or none";
        FlockError::unless(is_time, "decision_period_s", period, accepted)
    }

    /// The action for standardized features: the lean over [`LARGEST_LEAN`], or the rudder. It lies in [−1, 1].
    pub fn action(&self, features: &[f32]) -> f32 {
        let weighted_features = self.weights.iter().zip(features);
        let sum: f64 = weighted_features.fold(self.bias, |sum, (weight, &feature)| {
            sum + weight * f64::from(feature)
        });
        let action = if self.gains.is_some() {
            sum / LARGEST_LEAN
        } else {
            sum
        };
        let bounded = match self.bound {
            Bound::Tanh => libm::tanh(action),
            Bound::Clip => action.clamp(-1.0, 1.0),
        };
        bounded as f32
    }
}
