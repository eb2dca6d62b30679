//! Obstacles that stand in the water.

use super::field::Range;
use super::pools::Pool;
use super::value::{Kind, Setting, Value, wrong_kind};
use crate::error::{FlockError, Result};

/// The most discs, and the most walls, that a pool may have.
pub const MOST_OBSTACLES: usize = 1000;
/// The shortest wall in cm.
const SHORTEST_CM: f64 = 1e-3;

/// A disc that stands in the water.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Disc {
    /// Its center in cm, world axes.
    pub x_cm: f64,
    /// Its center in cm, world axes.
    pub y_cm: f64,
    /// Its radius in cm.
    pub radius_cm: f64,
}

/// A straight wall without thickness from one point to another.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wall {
    /// Where it starts, in cm, world axes.
    pub x0_cm: f64,
    /// Where it starts, in cm, world axes.
    pub y0_cm: f64,
    /// Where it ends, in cm, world axes.
    pub x1_cm: f64,
    /// Where it ends, in cm, world axes.
    pub y1_cm: f64,
}

/// A row of numbers that describes an obstacle.
pub(super) trait ObstacleRow: Copy {
    /// The field that holds such obstacles.
    const FIELD: &'static str;
    /// The names of the numbers.
    const COLUMNS: &'static [&'static str];
    /// What is wrong with the shape of an obstacle, if something is.
    fn flaw(&self) -> Option<&'static str>;
    /// The least and the largest distance of its points from the pool's center.
    fn distances(&self) -> (f64, f64);
    /// The numbers.
    fn numbers(&self) -> Vec<f64>;
    /// From as many numbers as there are columns.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;
}

impl ObstacleRow for Disc {
    const FIELD: &'static str = "discs";
    const COLUMNS: &'static [&'static str] = &["x_cm", "y_cm", "radius_cm"];

    fn flaw(&self) -> Option<&'static str> {
        let radius = self.radius_cm;
        (!(radius > 0.0 && radius <= Range::LARGE)).then_some("a positive radius, at most 1e6")
    }

    fn distances(&self) -> (f64, f64) {
        let center = libm::hypot(self.x_cm, self.y_cm);
        ((center - self.radius_cm).max(0.0), center + self.radius_cm)
    }

    fn numbers(&self) -> Vec<f64> {
        vec![self.x_cm, self.y_cm, self.radius_cm]
    }

    fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[x_cm, y_cm, radius_cm] = numbers else {
            return None;
        };
        Some(Self {
            x_cm,
            y_cm,
            radius_cm,
        })
    }
}

impl ObstacleRow for Wall {
    const FIELD: &'static str = "walls";
    const COLUMNS: &'static [&'static str] = &["x0_cm", "y0_cm", "x1_cm", "y1_cm"];

    fn flaw(&self) -> Option<&'static str> {
        (self.length_cm() < SHORTEST_CM).then_some("two ends at least 0.001 cm apart")
    }

    fn distances(&self) -> (f64, f64) {
        let (x, y) = (self.x1_cm - self.x0_cm, self.y1_cm - self.y0_cm);
        let along = -(self.x0_cm * x + self.y0_cm * y) / (x * x + y * y);
        let along = along.clamp(0.0, 1.0);
        let nearest = libm::hypot(self.x0_cm + along * x, self.y0_cm + along * y);
        let ends = [
            libm::hypot(self.x0_cm, self.y0_cm),
            libm::hypot(self.x1_cm, self.y1_cm),
        ];
        (nearest, ends[0].max(ends[1]))
    }

    fn numbers(&self) -> Vec<f64> {
        vec![self.x0_cm, self.y0_cm, self.x1_cm, self.y1_cm]
    }

    fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[x0_cm, y0_cm, x1_cm, y1_cm] = numbers else {
            return None;
        };
        Some(Self {
            x0_cm,
            y0_cm,
            x1_cm,
            y1_cm,
        })
    }
}

impl Wall {
    /// Its length in cm.
    pub fn length_cm(&self) -> f64 {
        libm::hypot(self.x1_cm - self.x0_cm, self.y1_cm - self.y0_cm)
    }
}

impl<T: ObstacleRow> Setting for Vec<T> {
    const KIND: Kind = Kind::Rows(T::COLUMNS);

    fn value(&self) -> Value {
        let rows = self.iter().map(|row| Value::reals(row.numbers()));
        Value::List(rows.collect())
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        let accepted = format!("rows of ({})", T::COLUMNS.join(", "));
        let Value::List(rows) = value else {
            return wrong_kind(name, accepted);
        };
        let mut obstacles = Self::new();
        for row in rows {
            let numbers = match row {
                Value::List(numbers) => numbers.iter().map(Value::number).collect(),
                other if other.number().is_some() => Some(Vec::new()),
                _ => None,
            };
            let Some(numbers) = numbers else {
                return wrong_kind(name, accepted);
            };
            let refuse = || FlockError::parameter(name, row, accepted.as_str());
            obstacles.push(T::from_numbers(&numbers).ok_or_else(refuse)?);
        }
        Ok(obstacles)
    }
}

/// Checks the obstacles of one kind: finite, well formed, and with a part in the water.
pub(super) fn check<T: ObstacleRow>(obstacles: &[T], pool: Pool) -> Result<()> {
    if obstacles.len() > MOST_OBSTACLES {
        let value = format!("{} rows", obstacles.len());
        return Err(FlockError::parameter(T::FIELD, value, "at most 1000 rows"));
    }
    for (number, obstacle) in obstacles.iter().enumerate() {
        let refuse = |accepted: &str| {
            let value = format!("{:?} (number {number})", obstacle.numbers());
            FlockError::parameter(T::FIELD, value, accepted)
        };
        // A NaN lies in no range.
        let is_near = |number: &f64| number.abs() <= Range::LARGE;
        if !obstacle.numbers().iter().all(is_near) {
            let columns = T::COLUMNS.join(", ");
            return Err(refuse(&format!("({columns}), each from -1e6 to 1e6")));
        }
        if let Some(accepted) = obstacle.flaw() {
            return Err(refuse(accepted));
        }
        let (least, largest) = obstacle.distances();
        if least >= pool.outer_radius_cm || largest <= pool.inner_radius_cm {
            let radii = format!("{} and {} cm", pool.inner_radius_cm, pool.outer_radius_cm);
            return Err(refuse(&format!(
                "an obstacle with a part in the water, between {radii} from the pool's center"
            )));
        }
    }
    Ok(())
}
