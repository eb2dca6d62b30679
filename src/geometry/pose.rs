//! Pose and velocity of a boat.

use super::{Vec2, wrap_angle};

/// The largest position (cm), heading (rad), velocity (cm/s) or angular velocity (rad/s) that a state
/// may hold. Squares and products of such numbers do not overflow.
pub(crate) const LARGEST: f64 = 1e9;

/// Whether the absolute values of all numbers are at most [`LARGEST`]; false for NaN.
fn are_in_range(numbers: [f64; 3]) -> bool {
    numbers.iter().all(|number| number.abs() <= LARGEST)
}

/// Position and heading of a boat.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Pose {
    /// Centroid in cm, world axes.
    pub position: Vec2,
    /// Heading α in rad, counter-clockwise from x; not wrapped, so that turns can be counted.
    pub heading: f64,
}

impl Pose {
    /// A pose from its three numbers [cm, cm, rad].
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self {
            position: Vec2::new(x, y),
            heading,
        }
    }

    /// The pose after moving with a velocity for a time.
    #[inline]
    pub fn moved(&self, velocity: &Velocity, dt: f64) -> Self {
        Self {
            position: self.position + velocity.linear * dt,
            heading: self.heading + velocity.angular * dt,
        }
    }

    /// Whether all three numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.position.x.is_finite() && self.position.y.is_finite() && self.heading.is_finite()
    }

    /// Whether no component exceeds [`LARGEST`].
    pub(crate) fn is_in_range(&self) -> bool {
        are_in_range([self.position.x, self.position.y, self.heading])
    }
}

/// Distance in cm between two sets of poses of the same boats: the square root of the mean over boats of
/// |Δx|² + ρ²Δα², the metric in which contacts change velocities least. Headings are compared modulo whole turns.
pub fn rms_distance(a: &[Pose], b: &[Pose], gyration_radius_cm: f64) -> f64 {
    let squared_distance = |(a, b): (&Pose, &Pose)| {
        let arc = gyration_radius_cm * wrap_angle(a.heading - b.heading);
        (a.position - b.position).norm_squared() + arc * arc
    };
    let sum: f64 = a.iter().zip(b).map(squared_distance).sum();
    (sum / a.len() as f64).sqrt()
}

/// Linear and angular velocity of a boat.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Velocity {
    /// Velocity of the centroid in cm/s, world axes.
    pub linear: Vec2,
    /// Angular velocity in rad/s, counter-clockwise.
    pub angular: f64,
}

impl Velocity {
    /// A velocity from its three numbers [cm/s, cm/s, rad/s].
    pub fn new(x: f64, y: f64, angular: f64) -> Self {
        Self {
            linear: Vec2::new(x, y),
            angular,
        }
    }

    /// Whether all three numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.linear.x.is_finite() && self.linear.y.is_finite() && self.angular.is_finite()
    }

    /// Whether no component exceeds [`LARGEST`].
    pub(crate) fn is_in_range(&self) -> bool {
        are_in_range([self.linear.x, self.linear.y, self.angular])
    }
}
