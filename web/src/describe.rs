//! The lists of parameters, policies and quantities, and the description of a flock, as JSON.

use crate::json::to_json;
use crate::live::{quantities, statistics};
use flockenv::analysis::quantities::Quantity;
use flockenv::contact::Statistics;
use flockenv::draw::palette::style_sheet;
use flockenv::environment::observation::ObservationLayout;
use flockenv::geometry::Hull;
use flockenv::integrator::Phase;
use flockenv::parameters::{Field, FlockParameters, Kind, Value};
use flockenv::policies::{Law, NamedLaw};
use serde_json::{Value as Json, json};

/// The name of a kind in the page's scripts.
fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Count => "count",
        Kind::Real => "real",
        Kind::Flag => "flag",
        Kind::Choice(_) => "choice",
        Kind::Choices(_) => "choices",
        Kind::Pool => "pool",
        Kind::Rows(_) => "rows",
        Kind::Map(_) => "map",
    }
}

/// The declaration of a parameter.
fn field(field: &Field<FlockParameters>) -> Json {
    json!({
        "name": field.name,
        "kind": kind_name(field.kind),
        "meaning": field.doc.split_whitespace().collect::<Vec<_>>().join(" "),
    })
}

/// The declaration of a statistic, whose kind follows from its value.
fn statistic((name, value): (String, Value)) -> Json {
    let kind = if matches!(value, Value::Count(_)) {
        Kind::Count
    } else {
        Kind::Real
    };
    json!({ "name": name, "kind": kind_name(kind) })
}

/// Parameters, laws, phases, quantities, statistics, entries of an observation, and the colors.
pub(crate) fn all() -> Json {
    let layout = ObservationLayout::default();
    let entries = layout.entries().into_iter();
    json!({
        "laws": Law::NAMED.iter().map(NamedLaw::declaration).map(|law| to_json(&law)).collect::<Json>(),
        "phases": Phase::names(),
        "fields": FlockParameters::FIELDS.iter().map(field).collect::<Json>(),
        "quantities": quantities().map(|quantity| to_json(&Quantity::declaration(quantity))).collect::<Json>(),
        "statistics": statistics(&Statistics::default()).into_iter().map(statistic).collect::<Json>(),
        "entries": entries
            .map(|(block, index, entry)| to_json(&entry.named(block.name(), index)))
            .collect::<Json>(),
        "colors": style_sheet(),
    })
}

/// The values of all parameters, and the lengths in cm that a picture needs; null for a missing outer wall.
pub(crate) fn values(parameters: &FlockParameters) -> Json {
    let fields = FlockParameters::FIELDS.iter().zip(parameters.values());
    let values: serde_json::Map<_, _> = fields
        .map(|(field, value)| (field.name.to_owned(), to_json(&value)))
        .collect();
    let (pool, hull) = (parameters.pool, Hull::new(parameters));
    let mut description = json!({
        "parameters": values,
        "lengths": {
            "outer_radius_cm": pool.has_outer_wall().then_some(pool.outer_radius_cm),
            "inner_radius_cm": pool.inner_radius_cm,
        },
    });
    for (name, length) in hull.lengths() {
        description["lengths"][name] = json!(length);
    }
    description
}
