//! Values of the core as JSON, the language of requests and answers.

use flockenv::parameters::{Kind, Value};
use serde_json::{Value as Json, json};

/// A value as JSON. Numbers that are not finite become text.
pub(crate) fn to_json(value: &Value) -> Json {
    match value {
        Value::None | Value::Other => Json::Null,
        Value::Flag(flag) => json!(flag),
        Value::Count(count) => json!(count),
        Value::Real(real) if !real.is_finite() => json!(real.to_string()),
        Value::Real(real) => json!(real),
        Value::Name(name) => json!(name),
        Value::List(values) => values.iter().map(to_json).collect(),
        Value::Map(values) => values
            .iter()
            .map(|(name, value)| (name.clone(), to_json(value)))
            .collect(),
    }
}

/// Reads the value of a field of this kind. Text is read as a number if the field holds numbers.
pub(crate) fn read(kind: Kind, json: &Json) -> Value {
    let holds_numbers = matches!(kind, Kind::Real | Kind::Pool | Kind::Rows(_));
    match json {
        Json::Bool(flag) => Value::Flag(*flag),
        Json::Number(number) => match number.as_u64().and_then(|count| count.try_into().ok()) {
            Some(count) => Value::Count(count),
            None => number.as_f64().map_or(Value::Other, Value::Real),
        },
        Json::String(text) => match text.parse() {
            Ok(real) if holds_numbers => Value::Real(real),
            _ => Value::Name(text.clone()),
        },
        Json::Array(values) => Value::List(values.iter().map(|value| read(kind, value)).collect()),
        Json::Null | Json::Object(_) => Value::Other,
    }
}
