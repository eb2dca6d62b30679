//! What there is, as lines of fields that tabs separate: the first field says what a line is.

use crate::leaders::POLICIES;
use crate::live::quantities;
use crate::request::{accepted, written};
use flockenv::analysis::quantities::Formula;
use flockenv::environment::observation::ObservationLayout;
use flockenv::geometry::Hull;
use flockenv::integrator::Phase;
use flockenv::parameters::{FlockParameters, Kind, Preset};

fn line(fields: &[&str]) -> String {
    let words = |field: &&str| field.split_whitespace().collect::<Vec<_>>().join(" ");
    fields.iter().map(words).collect::<Vec<_>>().join("\t") + "\n"
}

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

/// Presets, parameters, policies, phases, quantities and entries of an observation.
pub(crate) fn all() -> String {
    let mut text = String::new();
    for preset in Preset::ALL {
        text += &line(&["preset", preset.name()]);
    }
    for name in POLICIES {
        text += &line(&["policy", name]);
    }
    for phase in Phase::ALL {
        text += &line(&["phase", phase.name()]);
    }
    for field in FlockParameters::FIELDS {
        text += &line(&[
            "field",
            field.name,
            kind_name(field.kind),
            field.unit,
            &accepted(field),
            field.doc,
        ]);
    }
    for each in quantities() {
        let (low, high) = each.range.unwrap_or((f64::NAN, f64::NAN));
        let kind = if matches!(each.formula, Formula::Recorded(_)) {
            "recorded"
        } else {
            "derived"
        };
        let (low, high) = (low.to_string(), high.to_string());
        text += &line(&[
            "quantity",
            each.name,
            kind,
            each.label,
            each.symbol,
            each.unit,
            &low,
            &high,
            each.meaning,
        ]);
    }
    for (block, count, entry) in ObservationLayout::default().entries() {
        text += &line(&[
            "entry",
            block.name(),
            &count.to_string(),
            entry.name,
            entry.unit,
            entry.meaning,
        ]);
    }
    text
}

/// The values of all parameters, and lengths that a picture needs, in cm.
pub(crate) fn values(parameters: &FlockParameters) -> String {
    let fields = FlockParameters::FIELDS.iter().zip(parameters.values());
    let mut text: String = fields
        .map(|(field, value)| line(&["value", field.name, &written(&value)]))
        .collect();
    let (pool, hull) = (parameters.pool, Hull::new(parameters));
    for (name, length) in [
        ("outer_radius_cm", pool.outer_radius_cm),
        ("inner_radius_cm", pool.inner_radius_cm),
        ("hull_radius_cm", hull.radius),
        ("hull_half_length_cm", parameters.half_length_cm()),
    ] {
        text += &line(&["length", name, &length.to_string()]);
    }
    text
}
