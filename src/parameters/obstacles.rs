//! Obstacles that stand in the water.

use super::field::Range;
use super::pools::Pool;
use super::value::{Kind, Setting, Value, wrong_kind};
use crate::error::{FlockError, Result};

/// The most discs, and the most walls, that a pool may have.
pub const MOST_OBSTACLES: usize = 1000;
/// The shortest wall in cm.
const SHORTEST_CM: f64 = 1e-3;

/// Declares a row of numbers that describes an obstacle, and the field that holds such obstacles.
macro_rules! obstacle_row {
    ($(#[$meta:meta])* $type:ident in $field:literal { $($(#[$doc:meta])+ $column:ident,)+ }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $type { $($(#[$doc])+ pub $column: f64,)+ }

        impl Row for $type {
            const FIELD: &'static str = $field;
            const COLUMNS: &'static [&'static str] = &[$(stringify!($column)),+];

            fn numbers(&self) -> Vec<f64> {
                vec![$(self.$column),+]
            }

            fn from_numbers(numbers: &[f64]) -> Option<Self> {
                let &[$($column),+] = numbers else {
                    return None;
                };
                Some(Self { $($column),+ })
            }
        }
    };
}

obstacle_row! {
    /// A disc that stands in the water.
    Disc in "discs" {
        /// x of the center in cm.
        x_cm,
        /// y of the center in cm.
        y_cm,
        /// Its radius in cm.
        radius_cm,
    }
}

obstacle_row! {
    /// A straight wall without thickness from one point to another.
    Wall in "walls" {
        /// x of the first end in cm.
        x0_cm,
        /// y of the first end in cm.
        y0_cm,
        /// x of the second end in cm.
        x1_cm,
        /// y of the second end in cm.
        y1_cm,
    }
}

/// A row of numbers that have names.
pub(super) trait Row: Copy {
    /// The field that holds such rows.
    const FIELD: &'static str;
    /// The names of the numbers.
    const COLUMNS: &'static [&'static str];
    /// The numbers.
    fn numbers(&self) -> Vec<f64>;
    /// The row with these numbers; `None` unless there is one number per column.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;
}

/// A row that describes an obstacle.
pub(super) trait ObstacleRow: Row {
    /// The rule that the shape breaks, if it breaks one.
    fn broken_rule(&self) -> Option<&'static str>;
    /// The least and the greatest distance in cm of the obstacle's points from the pool's center.
    fn distances(&self) -> (f64, f64);
}

impl ObstacleRow for Disc {
    fn broken_rule(&self) -> Option<&'static str> {
        let radius = self.radius_cm;
        (!(radius > 0.0 && radius <= Range::LARGE)).then_some("a positive radius, at most 1e6")
    }

    fn distances(&self) -> (f64, f64) {
        let center = libm::hypot(self.x_cm, self.y_cm);
        ((center - self.radius_cm).max(0.0), center + self.radius_cm)
    }
}

impl ObstacleRow for Wall {
    fn broken_rule(&self) -> Option<&'static str> {
        (self.length_cm() < SHORTEST_CM).then_some("two ends at least 0.001 cm apart")
    }

    fn distances(&self) -> (f64, f64) {
        // The vector from the first end to the second.
        let (x, y) = (self.x1_cm - self.x0_cm, self.y1_cm - self.y0_cm);
        // The distance of the first end from the point nearest to the center, as a fraction of the wall's length.
        let fraction = -(self.x0_cm * x + self.y0_cm * y) / (x * x + y * y);
        let fraction = fraction.clamp(0.0, 1.0);
        let nearest = libm::hypot(self.x0_cm + fraction * x, self.y0_cm + fraction * y);
        let first_end = libm::hypot(self.x0_cm, self.y0_cm);
        let second_end = libm::hypot(self.x1_cm, self.y1_cm);
        (nearest, first_end.max(second_end))
    }
}

impl Wall {
    /// The wall's length in cm.
    pub fn length_cm(&self) -> f64 {
        libm::hypot(self.x1_cm - self.x0_cm, self.y1_cm - self.y0_cm)
    }
}

impl<T: Row> Setting for Vec<T> {
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
                // A lone number counts as a row of the wrong length, not as a value of the wrong type.
                lone if lone.number().is_some() => Some(Vec::new()),
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

/// Checks the obstacles of one kind: finite numbers, an accepted shape, and a part in the water.
pub(super) fn check<T: ObstacleRow>(obstacles: &[T], pool: Pool) -> Result<()> {
    let (count, most) = (obstacles.len(), MOST_OBSTACLES);
    let accepted = format!("at most {most} rows");
    FlockError::unless(count <= most, T::FIELD, format!("{count} rows"), accepted)?;
    for (number, obstacle) in obstacles.iter().enumerate() {
        let check = |is_accepted: bool, accepted: String| {
            let value = format!("{:?} (number {number})", obstacle.numbers());
            FlockError::unless(is_accepted, T::FIELD, value, accepted)
        };
        // A NaN lies in no range.
        let are_near = obstacle
            .numbers()
            .iter()
            .all(|number| number.abs() <= Range::LARGE);
        let columns = T::COLUMNS.join(", ");
        check(are_near, format!("({columns}), each from -1e6 to 1e6"))?;
        let broken_rule = obstacle.broken_rule();
        let accepted = broken_rule.unwrap_or_default().to_owned();
        check(broken_rule.is_none(), accepted)?;
        let (nearest, farthest) = obstacle.distances();
        let (inner, outer) = (pool.inner_radius_cm, pool.outer_radius_cm);
        let accepted = format!(
            "an obstacle with a part in the water, between {inner} and {outer} cm from the pool's center"
        );
        check(nearest < outer && farthest > inner, accepted)?;
    }
    Ok(())
}
