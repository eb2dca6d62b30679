//! The water that boats move in.

use super::value::{Kind, Setting, Value, wrong_kind};
use crate::error::{FlockError, Result};

/// The water: an annulus, a disc (inner radius 0) or open water (outer radius infinite).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pool {
    /// Radius of the outer wall in cm; infinite: no outer wall.
    pub outer_radius_cm: f64,
    /// Radius of the obstacle in the middle in cm; 0: no obstacle.
    pub inner_radius_cm: f64,
}

impl Pool {
    /// Table 1 as printed: diameters 180 and 97 cm.
    pub const NARROW: Self = Self {
        outer_radius_cm: 90.0,
        inner_radius_cm: 48.5,
    };
    /// Section 2.2's "500 boats" of free space: radii 180 and 97 cm.
    pub const WIDE: Self = Self {
        outer_radius_cm: 180.0,
        inner_radius_cm: 97.0,
    };
    /// Names of the pools, as users write them.
    pub(crate) const NAMED: [(&'static str, Self); 2] =
        [("wide", Self::WIDE), ("narrow", Self::NARROW)];

    /// The pool with this name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] lists the known names.
    pub fn named(name: &str) -> Result<Self> {
        let entry = Self::NAMED.iter().find(|(known, _)| *known == name);
        entry.map(|&(_, pool)| pool).ok_or_else(|| {
            let accepted = "\"wide\", \"narrow\" or (outer_radius_cm, inner_radius_cm)";
            FlockError::parameter("pool", format!("{name:?}"), accepted)
        })
    }

    /// The name of this pool, if it has one.
    pub fn name(&self) -> Option<&'static str> {
        Self::NAMED
            .iter()
            .find(|(_, pool)| pool == self)
            .map(|&(name, _)| name)
    }

    /// Whether there is an outer wall.
    pub fn has_outer_wall(&self) -> bool {
        self.outer_radius_cm.is_finite()
    }

    /// Whether there is any wall.
    pub fn has_walls(&self) -> bool {
        self.has_outer_wall() || self.has_inner_wall()
    }

    /// Whether there is an obstacle in the middle.
    pub fn has_inner_wall(&self) -> bool {
        self.inner_radius_cm > 0.0
    }
}

impl Setting for Pool {
    const KIND: Kind = Kind::Pool;

    fn value(&self) -> Value {
        let radii = [self.outer_radius_cm, self.inner_radius_cm];
        self.name().map_or(Value::reals(radii), Value::from)
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match (value, value.pair()) {
            (Value::Name(text), _) => Self::named(text),
            (_, Some((outer_radius_cm, inner_radius_cm))) => Ok(Self {
                outer_radius_cm,
                inner_radius_cm,
            }),
            _ => wrong_kind(name, "a pool's name or (outer_radius_cm, inner_radius_cm)"),
        }
    }
}
