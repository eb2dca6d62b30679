//! The table of the quantities that are measured at one time, each with its name, unit, meaning and formula. Recordings,
//! tables of sweeps, the command line, episode summaries and the replay page iterate over the table.

use super::OrderParameters;
use super::structure::{largest_cluster, on_outer_wall, polarization};
use crate::error::{FlockError, Result};
use crate::geometry::{HullPose, LapFrame, Pose, Vec2, Velocity, cross};
use crate::parameters::{FlockParameters, Target, Value, named_fields};
use std::f64::consts::{FRAC_PI_2, PI};

/// Boats at one time, with the order parameters that several quantities share.
#[derive(Debug, Clone, Copy)]
pub struct Boats<'a> {
    /// Their hulls.
    pub hulls: &'a [HullPose],
    /// Their velocities.
    pub velocities: &'a [Velocity],
    /// Their order parameters (Section 3.2).
    pub order: OrderParameters,
}

impl Boats<'_> {
    /// Mean over the boats of a vector that is computed from each boat's orientation. Both vectors are in LAP axes.
    fn mean(&self, vector: impl Fn(Vec2) -> Vec2) -> Vec2 {
        let sum = self.hulls.iter().fold(Vec2::zeros(), |sum, hull| {
            sum + vector(LapFrame::at(hull.center).components(hull.axis))
        });
        sum / self.hulls.len() as f64
    }
}

/// A quantity's formula; the variants differ in its arguments.
#[derive(Debug, Clone, Copy)]
pub enum Formula {
    /// Computed from the boats at a time. Recordings keep it with every sample.
    Recorded(fn(&Boats) -> f64),
    /// Computed from order parameters and the target direction.
    Derived(fn(&OrderParameters, Target) -> f64),
    /// Computed from poses and parameters. It is slower, so it is computed only on request.
    Structure(fn(&[Pose], &FlockParameters) -> f64),
}

/// An entry of the table.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Name in recordings, tables and files.
    pub name: &'static str,
    /// Label in a few words.
    pub label: &'static str,
    /// Symbol; empty: no symbol.
    pub symbol: &'static str,
    /// Unit; empty for pure numbers.
    pub unit: &'static str,
    /// Meaning, with its sign.
    pub meaning: &'static str,
    /// The paper's section or equation that defines it.
    pub source: &'static str,
    /// Least and greatest value, or `None`.
    pub range: Option<(f64, f64)>,
    /// Least number of boats for which it is defined.
    pub least_boats: usize,
    /// Whether its mean over a run is shown; the mean of an angle is not.
    pub is_averaged: bool,
    /// The formula.
    pub formula: Formula,
}

const FRACTION: Option<(f64, f64)> = Some((0.0, 1.0));
const SIGNED: Option<(f64, f64)> = Some((-1.0, 1.0));
const ANGLE: Option<(f64, f64)> = Some((-PI, PI));

/// Every quantity, the recorded ones first.
#[rustfmt::skip]
pub const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "psi_o", label: "order", symbol: "Ψ_o", unit: "", range: FRACTION, least_boats: 1, is_averaged: true,
        meaning: "length of the mean orientation; some 0.886/√N for N disordered boats", source: "eq. (1)",
        formula: Formula::Recorded(|boats| boats.order.psi_o),
    },
    Quantity {
        name: "phi_o", label: "angle", symbol: "φ_o", unit: "rad", range: ANGLE, least_boats: 1, is_averaged: false,
        meaning: "angle of the mean orientation: 0 is jammed outward, +π/2 clockwise", source: "eq. (3)",
        formula: Formula::Recorded(|boats| boats.order.phi_o),
    },
    Quantity {
        name: "c_o", label: "correlation", symbol: "C_o", unit: "", range: None, least_boats: 2, is_averaged: true,
        meaning: "mean dot product of the orientations of two different boats, in [-1, 1]",
        source: "eq. (2), each pair once",
        formula: Formula::Recorded(|boats| boats.order.c_o),
    },
    Quantity {
        name: "psi_v", label: "velocity", symbol: "Ψ_v", unit: "cm/s", range: None, least_boats: 1, is_averaged: true,
        meaning: "length of the mean velocity", source: "eq. (4)",
        formula: Formula::Recorded(|boats| boats.order.psi_v),
    },
    Quantity {
        name: "phi_v", label: "angle", symbol: "φ_v", unit: "rad", range: ANGLE, least_boats: 1, is_averaged: false,
        meaning: "angle of the mean velocity", source: "eq. (6)",
        formula: Formula::Recorded(|boats| boats.order.phi_v),
    },
    Quantity {
        name: "c_v", label: "correlation", symbol: "C_v", unit: "cm²/s²", range: None, least_boats: 2, is_averaged: true,
        meaning: "mean dot product of the velocities of two different boats", source: "eq. (5)",
        formula: Formula::Recorded(|boats| boats.order.c_v),
    },
    Quantity {
        name: "nematic", label: "nematic order", symbol: "Ψ_n", unit: "", range: FRACTION, least_boats: 1, is_averaged: true,
        meaning: "|mean exp(2iφ)| of the LAP orientations φ: 1 also if boats head in opposite directions",
        source: "two-dimensional nematic order parameter",
        formula: Formula::Recorded(|boats| {
            boats.mean(|o| Vec2::new(o.x * o.x - o.y * o.y, 2.0 * o.x * o.y)).norm()
        }),
    },
    Quantity {
        name: "milling", label: "milling", symbol: "M", unit: "", range: SIGNED, least_boats: 1, is_averaged: true,
        meaning: "angular momentum about the pool's center over its greatest value at these speeds and radii: \
                  +1 all clockwise; 0 if nothing moves",
        source: "Σ r×v / Σ|r||v|",
        formula: Formula::Recorded(|boats| {
            let (mut momentum, mut greatest) = (0.0, 0.0);
            for (hull, velocity) in boats.hulls.iter().zip(boats.velocities) {
                momentum -= cross(hull.center, velocity.linear);
                greatest += hull.center.norm() * velocity.linear.norm();
            }
            if greatest > 0.0 { momentum / greatest } else { 0.0 }
        }),
    },
    Quantity {
        name: "signed_order", label: "signed order", symbol: "", unit: "", range: SIGNED, least_boats: 1,
        is_averaged: true, meaning: "Ψ_o·cos(φ_o - φ_target)", source: "the reward of the environments",
        formula: Formula::Derived(OrderParameters::signed_order),
    },
    Quantity {
        name: "rotation", label: "rotation, clockwise positive", symbol: "m", unit: "", range: SIGNED, least_boats: 1,
        is_averaged: true, meaning: "Ψ_o·sin φ_o: ±1 for rotation in order, 0 for a jam", source: "",
        formula: Formula::Derived(|order, _| order.rotation()),
    },
    Quantity {
        name: "outward", label: "outward order", symbol: "", unit: "", range: SIGNED, least_boats: 1, is_averaged: false,
        meaning: "Ψ_o·cos φ_o: 1 for a jam, near 0 for streams along the pool", source: "",
        formula: Formula::Derived(|order, _| order.outward()),
    },
    Quantity {
        name: "off_tangent", label: "angle off the tangent", symbol: "", unit: "rad", range: Some((0.0, FRAC_PI_2)),
        least_boats: 1, is_averaged: false, meaning: "||φ_o| - π/2|: 0 for boats that point along the pool",
        source: "eq. (7)",
        formula: Formula::Derived(|order, _| super::collective_state::off_tangent(order.phi_o)),
    },
    Quantity {
        name: "largest_cluster", label: "largest cluster", symbol: "", unit: "", range: FRACTION, least_boats: 1,
        is_averaged: false, meaning: "part of the boats that the largest cluster holds: boats joined by gaps below \
                                      0.5 cm", source: "",
        formula: Formula::Structure(largest_cluster),
    },
    Quantity {
        name: "on_outer_wall", label: "on the outer wall", symbol: "", unit: "", range: FRACTION, least_boats: 1,
        is_averaged: false, meaning: "part of the boats within 0.5 cm of the outer wall", source: "",
        formula: Formula::Structure(on_outer_wall),
    },
    Quantity {
        name: "polarization", label: "polarization", symbol: "", unit: "", range: FRACTION, least_boats: 1,
        is_averaged: false, meaning: "length of the mean heading in world axes: 1 if all boats point the same way, \
                                      wherever they are", source: "Vicsek et al. (1995)",
        formula: Formula::Structure(|poses, _| polarization(poses)),
    },
];

impl Quantity {
    /// The fields of the entry by name.
    pub fn declaration(&self) -> Value {
        let kind = match self.formula {
            Formula::Recorded(_) => "recorded",
            Formula::Derived(_) => "derived",
            Formula::Structure(_) => "structure",
        };
        let declared = named_fields!(self; name label symbol unit meaning source range least_boats
            is_averaged);
        let fields = declared.into_iter().chain([("kind", kind.into())]);
        fields.collect()
    }

    /// Whether episode summaries hold the quantity's mean.
    const fn is_summarized(&self) -> bool {
        self.is_averaged && !matches!(self.formula, Formula::Structure(_))
    }
}

/// Numbers of quantities in the table.
struct Counts {
    recorded: usize,
    summarized: usize,
}

const COUNTS: Counts = {
    let (mut recorded, mut summarized, mut index) = (0, 0, 0);
    while index < QUANTITIES.len() {
        let quantity = &QUANTITIES[index];
        if matches!(quantity.formula, Formula::Recorded(_)) {
            assert!(
                index == recorded,
                "recorded quantities come first in the table"
            );
            recorded += 1;
        }
        summarized += quantity.is_summarized() as usize;
        index += 1;
    }
    Counts {
        recorded,
        summarized,
    }
};

/// Number of recorded quantities.
pub const RECORDED: usize = COUNTS.recorded;

/// Number of quantities averaged in an episode summary.
pub(crate) const SUMMARIZED: usize = COUNTS.summarized;

/// The quantities averaged in an episode summary, in the order of the table.
pub(crate) fn summarized() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES
        .iter()
        .filter(|quantity| quantity.is_summarized())
}

/// Present values of the quantities that an episode summary averages.
pub(crate) fn summarized_values(boats: &Boats, target: Target) -> [f64; SUMMARIZED] {
    let mut values = [f64::NAN; SUMMARIZED];
    for (value, quantity) in values.iter_mut().zip(summarized()) {
        match quantity.formula {
            Formula::Recorded(formula) => *value = formula(boats),
            Formula::Derived(formula) => *value = formula(&boats.order, target),
            Formula::Structure(_) => {}
        }
    }
    values
}

/// The recorded quantities of a sample, in the order of the table.
pub type Recorded = [f64; RECORDED];

/// The recorded quantities of boats (two slices of equal length).
///
/// # Errors
/// [`FlockError::Parameter`] if there is no boat.
pub fn recorded(hulls: &[HullPose], velocities: &[Velocity]) -> Result<Recorded> {
    let boats = Boats {
        hulls,
        velocities,
        order: OrderParameters::from_hulls(hulls, velocities)?,
    };
    let mut values = [f64::NAN; RECORDED];
    for (value, quantity) in values.iter_mut().zip(QUANTITIES) {
        if let Formula::Recorded(formula) = quantity.formula {
            *value = formula(&boats);
        }
    }
    Ok(values)
}

/// The quantity with this name.
///
/// # Errors
/// [`FlockError::Parameter`] lists the known names.
pub fn quantity(name: &str) -> Result<&'static Quantity> {
    let quantity = QUANTITIES.iter().find(|quantity| quantity.name == name);
    quantity.ok_or_else(|| {
        let names: Vec<_> = QUANTITIES.iter().map(|quantity| quantity.name).collect();
        let accepted = format!("one of {}", names.join(", "));
        FlockError::parameter("quantity", format!("{name:?}"), accepted)
    })
}
