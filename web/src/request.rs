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
        let mut values = defaults.values().into_iter();
        let mut parameters = FlockParameters::from_values(|field| {
            let default = values.next().unwrap_or(Value::Flag(false));
            find(field.name).map_or(Ok(default), |text| value_of(field, text))
        })?;
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

fn value_of(field: &'static Field, text: &str) -> Result<Value> {
    let refuse = || FlockError::parameter(field.name, shown(text), accepted(field));
    let numbers = |text: &str| -> Result<Vec<f64>> {
        text.split(',')
            .map(|each| each.trim().parse().map_err(|_| refuse()))
            .collect()
    };
    Ok(match field.kind {
        Kind::Count => Value::Count(text.parse().map_err(|_| refuse())?),
        Kind::Real => Value::Real(text.parse().map_err(|_| refuse())?),
        Kind::Flag => Value::Flag(text.parse().map_err(|_| refuse())?),
        Kind::Choice(names) if !names().contains(&text) => return Err(refuse()),
        Kind::Choice(_) => Value::Name(text.to_owned()),
        Kind::Choices(names) => {
            let each: Vec<_> = text.split(',').map(str::to_owned).collect();
            if !each.iter().all(|name| names().contains(&name.as_str())) {
                return Err(refuse());
            }
            match <[String; 1]>::try_from(each) {
                Ok([name]) => Value::Name(name),
                Err(names) => Value::Names(names),
            }
        }
        Kind::Pool if text.contains(',') => match numbers(text)?[..] {
            [outer, inner] => Value::Radii(outer, inner),
            _ => return Err(refuse()),
        },
        Kind::Pool => Value::Name(shown(text)),
        Kind::Rows(names) => {
            let rows = text.split(';').filter(|row| !row.is_empty()).map(numbers);
            let rows = rows.collect::<Result<Vec<_>>>()?;
            if rows.iter().any(|row| row.len() != names.len()) {
                return Err(refuse());
            }
            Value::Rows(rows)
        }
    })
}

/// Which values a field accepts, in words.
pub(crate) fn accepted(field: &Field) -> String {
    match field.kind {
        Kind::Choice(names) => names().join(", "),
        Kind::Choices(names) => format!(
            "{}, or a list of them, one per leader",
            names().join(" or ")
        ),
        Kind::Flag => "true or false".to_owned(),
        Kind::Count | Kind::Real | Kind::Pool | Kind::Rows(_) => field.range.accepted().to_owned(),
    }
}

/// A value as requests and links have it.
pub(crate) fn written(value: &Value) -> String {
    match value {
        Value::Names(names) => names.join(","),
        Value::Radii(outer, inner) => format!("{outer},{inner}"),
        Value::Rows(rows) => {
            let rows = rows.iter().map(|row| {
                let numbers: Vec<_> = row.iter().map(f64::to_string).collect();
                numbers.join(",")
            });
            rows.collect::<Vec<_>>().join(";")
        }
        other => other.to_string(),
    }
}
