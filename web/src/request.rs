//! What the page asks for: parameters by name, a seed, and how leaders steer.

use crate::json::read;
use crate::leaders::EVERY_SUBSTEP;
use flockenv::geometry::resized_gyration_radius_cm;
use flockenv::parameters::{FlockParameters, Preset};
use flockenv::{FlockError, Result};
use serde_json::{Map, Value as Json};

/// Letters of a value that a message shows.
const SHOWN: usize = 40;

/// A request as it is written. The seed is text: JavaScript has no whole numbers of 64 bits.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    preset: Option<String>,
    seed: Option<String>,
    leaders: Option<String>,
    #[serde(default)]
    parameters: Map<String, Json>,
}

/// A flock that is wanted.
pub(crate) struct Request {
    /// Its parameters, checked.
    pub parameters: FlockParameters,
    /// Its seed.
    pub seed: u64,
    /// How its leaders steer, by name.
    pub leaders: String,
}

impl Request {
    /// A request from JSON: `preset`, `seed`, `leaders`, and fields of the parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for what is unknown, unreadable or out of range.
    pub fn read(text: &str) -> Result<Self> {
        let written: Written = serde_json::from_str(text)
            .map_err(|error| FlockError::parameter("request", error, "JSON"))?;
        let preset: Preset = written.preset.as_deref().unwrap_or("simulation").parse()?;
        let seed = written.seed.as_deref().unwrap_or("0");
        let seed = seed.parse().map_err(|_| {
            FlockError::parameter("seed", shown(seed), "a whole number from 0 to 2^64 - 1")
        })?;
        let defaults = FlockParameters::preset(preset);
        let mut parameters = defaults.clone();
        for field in FlockParameters::FIELDS {
            if let Some(json) = written.parameters.get(field.name) {
                let outcome = (field.set)(&mut parameters, &read(field.kind, json));
                outcome.map_err(|error| match error {
                    FlockError::Kind { .. } => {
                        let given = json
                            .as_str()
                            .map_or_else(|| json.to_string(), str::to_owned);
                        FlockError::parameter(field.name, shown(&given), field.accepted())
                    }
                    other => other,
                })?;
            }
        }
        if !written.parameters.contains_key("gyration_radius_cm") {
            parameters.gyration_radius_cm = resized_gyration_radius_cm(
                &defaults,
                parameters.boat_radius_cm,
                parameters.boat_shape,
            );
        }
        parameters.check()?;
        Ok(Self {
            parameters,
            seed,
            leaders: written.leaders.unwrap_or(EVERY_SUBSTEP.to_owned()),
        })
    }
}

fn shown(text: &str) -> String {
    let mut letters = text.chars();
    let start: String = letters.by_ref().take(SHOWN).collect();
    if letters.next().is_some() {
        format!("{start}…")
    } else {
        start
    }
}
