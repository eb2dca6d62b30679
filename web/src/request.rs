//! What the page asks for: parameters by name, a seed, and how leaders steer.

use crate::leaders::EVERY_SUBSTEP;
use flockenv::geometry::resized_gyration_radius_cm;
use flockenv::parameters::{Field, FlockParameters, Kind, Preset, Value};
use flockenv::{FlockError, Result};

/// Letters of a value that a message shows.
const SHOWN: usize = 40;

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
    /// A request from lines `name=value`: `preset`, `seed`, `leaders`, and fields of the parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for what is unknown, unreadable or out of range.
    pub fn read(text: &str) -> Result<Self> {
        let given: Vec<_> = text
            .lines()
            .filter_map(|line| line.split_once('='))
            .collect();
        let find = |name: &str| {
            given
                .iter()
                .find(|(each, _)| *each == name)
                .map(|(_, value)| *value)
        };
        let preset: Preset = find("preset").unwrap_or("simulation").parse()?;
        let seed = find("seed").unwrap_or("0");
        let seed = seed.parse().map_err(|_| {
            FlockError::parameter("seed", shown(seed), "a whole number from 0 to 2^64 - 1")
        })?;
        let defaults = FlockParameters::preset(preset);
        let mut parameters = defaults.clone();
        for field in FlockParameters::FIELDS {
            if let Some(text) = find(field.name) {
                let outcome = (field.set)(&mut parameters, &value_of(field.kind, text));
                outcome.map_err(|error| match error {
                    FlockError::Kind { .. } => {
                        FlockError::parameter(field.name, shown(text), accepted(field))
                    }
                    other => other,
                })?;
            }
        }
        if find("gyration_radius_cm").is_none() {
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
            leaders: find("leaders").unwrap_or(EVERY_SUBSTEP).to_owned(),
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

fn value_of(kind: Kind, text: &str) -> Value {
    let number = |text: &str| text.trim().parse().map_or(Value::Other, Value::Real);
    let numbers = |text: &str| Value::List(text.split(',').map(number).collect());
    let name = |text: &str| Value::Name(shown(text));
    match kind {
        Kind::Count => text.parse().map_or(Value::Other, Value::Count),
        Kind::Real => number(text),
        Kind::Flag => text.parse().map_or(Value::Other, Value::Flag),
        Kind::Pool if text.contains(',') => numbers(text),
        Kind::Choices(_) if text.contains(',') => Value::List(text.split(',').map(name).collect()),
        Kind::Choice(_) | Kind::Choices(_) | Kind::Pool | Kind::Map(_) => name(text),
        Kind::Rows(_) => {
            let rows = text.split(';').filter(|row| !row.is_empty());
            Value::List(rows.map(numbers).collect())
        }
    }
}

/// Which values a field accepts, in words.
pub(crate) fn accepted(field: &Field<FlockParameters>) -> String {
    match field.kind {
        Kind::Choice(names) => names().join(", "),
        Kind::Choices(names) => format!(
            "{}, or a list of them, one per leader",
            names().join(" or ")
        ),
        Kind::Flag => "true or false".to_owned(),
        Kind::Count | Kind::Real | Kind::Pool | Kind::Rows(_) | Kind::Map(_) => {
            field.range.accepted().to_owned()
        }
    }
}

/// A value as requests and links have it.
pub(crate) fn written(value: &Value) -> String {
    match value {
        Value::Name(name) => name.clone(),
        Value::List(values) => {
            let are_rows = matches!(values.first(), Some(Value::List(_)));
            let each: Vec<_> = values.iter().map(written).collect();
            each.join(if are_rows { ";" } else { "," })
        }
        other => other.to_string(),
    }
}
