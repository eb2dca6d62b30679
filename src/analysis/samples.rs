//! Boats at many times. At some times boats may be missing, as in tracks of robots and animals.

use super::quantities::{RECORDED, Recorded, recorded};
use crate::error::Result;
use crate::geometry::{HullPose, Pose, Velocity};

/// Poses or velocities of the same boats at many times. Each row has three numbers. A row with a number that is not
/// finite stands for a missing boat.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    rows: Vec<Pose>,
    boats: usize,
}

impl Samples {
    /// Samples from rows of [x, y, heading] or [x velocity, y velocity, angular velocity], in order of time.
    pub fn new(rows: Vec<Pose>, boats: usize) -> Self {
        Self {
            rows,
            boats: boats.max(1),
        }
    }

    /// Numbers of times and boats.
    pub fn shape(&self) -> (usize, usize) {
        (self.rows.len() / self.boats, self.boats)
    }

    /// All rows.
    pub fn rows(&self) -> &[Pose] {
        &self.rows
    }

    /// The rows of each time, in order of time.
    pub fn by_time(&self) -> impl Iterator<Item = &[Pose]> {
        self.rows.chunks_exact(self.boats)
    }

    /// The rows of the boats that are present at each time, in order of time.
    pub fn present(&self) -> impl Iterator<Item = Vec<Pose>> {
        self.by_time()
            .map(|rows| rows.iter().filter(|row| row.is_finite()).copied().collect())
    }

    /// The recorded quantities at each time, over the boats that have both a pose and a velocity; NaN if no boat has
    /// both.
    ///
    /// # Errors
    /// Those of [`recorded`].
    pub fn recorded(&self, velocities: &Self) -> Result<Vec<Recorded>> {
        let velocity = |row: &Pose| Velocity::new(row.position.x, row.position.y, row.heading);
        let mut hulls = Vec::new();
        let times = self.by_time().zip(velocities.by_time());
        times
            .map(|(poses, velocity_rows)| {
                let boats = poses.iter().zip(velocity_rows);
                let present = boats.filter(|(pose, row)| pose.is_finite() && row.is_finite());
                let (poses, velocities): (Vec<_>, Vec<_>) =
                    present.map(|(pose, row)| (*pose, velocity(row))).unzip();
                HullPose::replace_all(&mut hulls, &poses);
                if hulls.is_empty() {
                    return Ok([f64::NAN; RECORDED]);
                }
                recorded(&hulls, &velocities)
            })
            .collect()
    }

    /// Velocities from poses, and the number of steps that were too fast. `times_s` holds the time of each row: each
    /// boat may have its own clock.
    ///
    /// A step is the motion of a boat from one time to the next. If a row has a step before and after it, its velocity is
    /// the mean of both steps' velocities, each weighted by the other step's duration. This is exact for a constant
    /// acceleration. If a row has one step, its velocity is that step's. If it has none, its velocity is NaN.
    ///
    /// Steps longer than `longest_s` and steps faster than `fastest_cm_s` are left out.
    pub fn velocities(&self, times_s: &[f64], longest_s: f64, fastest_cm_s: f64) -> (Self, usize) {
        let mut too_fast = 0;
        // Velocity and duration of the step that ends at a row; `None` if the step is left out. A first row ends no step.
        let mut step_to = |row: usize| {
            let previous = row.checked_sub(self.boats)?;
            let duration_s = times_s.get(row)? - times_s[previous];
            let velocity = mean_velocity(&self.rows[previous], &self.rows[row], duration_s);
            if !velocity.is_finite() || duration_s > longest_s {
                return None;
            }
            let is_fast = velocity.position.norm_squared() > fastest_cm_s * fastest_cm_s;
            too_fast += usize::from(is_fast);
            (!is_fast).then_some((velocity, duration_s))
        };
        // Beyond the last row there is one more `None` for each boat.
        let steps: Vec<_> = (0..self.rows.len() + self.boats)
            .map(&mut step_to)
            .collect();
        let velocity = |row: usize| match (steps[row], steps[row + self.boats]) {
            (Some((before, before_s)), Some((after, after_s))) => {
                weighted_velocity(&before, &after, after_s / (before_s + after_s))
            }
            (Some((only, _)), None) | (None, Some((only, _))) => only,
            (None, None) => Pose::new(f64::NAN, f64::NAN, f64::NAN),
        };
        let velocities = (0..self.rows.len()).map(velocity).collect();
        (Self::new(velocities, self.boats), too_fast)
    }
}

/// The mean velocity of a motion from one pose to another, as a row.
fn mean_velocity(from: &Pose, to: &Pose, duration_s: f64) -> Pose {
    let velocity = (to.position - from.position) * duration_s.recip();
    let angular = (to.heading - from.heading) / duration_s;
    Pose::new(velocity.x, velocity.y, angular)
}

/// The mean of two velocities, stored as poses are, of which the first has this weight.
fn weighted_velocity(first: &Pose, second: &Pose, weight: f64) -> Pose {
    let mix = |x: f64, y: f64| x * weight + y * (1.0 - weight);
    Pose::new(
        mix(first.position.x, second.position.x),
        mix(first.position.y, second.position.y),
        mix(first.heading, second.heading),
    )
}
