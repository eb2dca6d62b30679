//! Requests of the page: parameters by name, a seed, and how leaders steer.

use crate::json::read;
use crate::leaders::{EVERY_SUBSTEP, Leaders};
use flockenv::geometry::resized_gyration_radius_cm;
use flockenv::parameters::{Field, FlockParameters, Preset};
use flockenv::{FlockError, Result};
use serde_json::{Map, Value as Json};

/// The most letters of a value in an error message.
const MOST_LETTERS: usize = 40;

/// The fields of a request in JSON. The seed is text, since JavaScript's numbers do not hold all integers of 64 bits.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RequestFields {
    preset: Option<String>,
    seed: Option<String>,
    leaders: Option<String>,
    trained: Option<String>,
    #[serde(default)]
    parameters: Map<String, Json>,
}

/// A requested flock.
pub(crate) struct Request {
    /// Its parameters, checked.
    pub parameters: FlockParameters,
    /// Its seed.
    pub seed: u64,
    /// How its leaders steer, by name.
    leaders: String,
    /// The policy that the visitor trained, in JSON, if there is one.
    trained: Option<String>,
}

/// Sets the fields that have a value in `requested`, by name. Other names are ignored.
///
/// # Errors
/// [`FlockError::Parameter`] for values that are unreadable. Ranges are not checked.
pub(crate) fn set_fields<T>(
    settings: &mut T,
    fields: &[Field<T>],
    requested: &Map<String, Json>,
) -> Result<()> {
    for field in fields {
        let Some(json) = requested.get(field.name) else {
            continue;
        };
        (field.set)(settings, &read(field.kind, json)).map_err(|error| match error {
            FlockError::Kind { .. } => {
                let text = json
                    .as_str()
                    .map_or_else(|| json.to_string(), str::to_owned);
                FlockError::parameter(field.name, shortened(&text), field.accepted())
            }
            other => other,
        })?;
    }
    Ok(())
}

impl Request {
    /// A request from the JSON of [`RequestFields`]. Unknown parameters, as of a later version's recording, are ignored.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other unknown fields, and for values that are unreadable or out of range.
    pub fn read(text: &str) -> Result<Self> {
        let requested: RequestFields = serde_json::from_str(text)
            .map_err(|error| FlockError::parameter("request", error, "JSON"))?;
        Self::checked(requested)
    }

    /// Checks a request that was read from JSON.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn checked(requested: RequestFields) -> Result<Self> {
        let preset: Preset = requested
            .preset
            .as_deref()
            .unwrap_or("simulation")
            .parse()?;
        let seed = requested.seed.as_deref().unwrap_or("0");
        let seed = seed.parse().map_err(|_| {
            FlockError::parameter("seed", shortened(seed), "a whole number from 0 to 2^64 - 1")
        })?;
        let defaults = FlockParameters::preset(preset);
        let mut parameters = defaults.clone();
        set_fields(
            &mut parameters,
            FlockParameters::FIELDS,
            &requested.parameters,
        )?;
        if !requested.parameters.contains_key("gyration_radius_cm") {
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
            leaders: requested.leaders.unwrap_or(EVERY_SUBSTEP.to_owned()),
            trained: requested.trained,
        })
    }

    /// The leaders of the requested flock.
    ///
    /// # Errors
    /// As for [`Leaders::named`].
    pub fn leaders(&self) -> Result<Leaders> {
        Leaders::named(&self.leaders, self.trained.as_deref(), &self.parameters)
    }
}

/// Cuts a text to [`MOST_LETTERS`]; an ellipsis marks the cut.
fn shortened(text: &str) -> String {
    let mut letters = text.chars();
    let start: String = letters.by_ref().take(MOST_LETTERS).collect();
    if letters.next().is_some() {
        format!("{start}…")
    } else {
        start
    }
}
