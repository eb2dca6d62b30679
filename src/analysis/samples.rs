//! Boats at many times, some of them missing: tracks of robots and animals have gaps.

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

    /// The recorded quantities at each time, over the boats that have both a pose and a velocity; NaN if there are
    /// none.
    ///
    /// # Errors
    /// Those of [`recorded`].
    pub fn recorded(&self, velocities: &Self) -> Result<Vec<Recorded>> {
        let velocity = |row: &Pose| Velocity::new(row.position.x, row.position.y, row.heading);
        let mut hulls = Vec::new();
        let times = self.by_time().zip(velocities.by_time());
        times
            .map(|(poses, rows)| {
                let both = poses.iter().zip(rows);
                let both = both.filter(|(pose, row)| pose.is_finite() && row.is_finite());
                let (poses, velocities): (Vec<_>, Vec<_>) =
                    both.map(|(pose, row)| (*pose, velocity(row))).unzip();
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
    /// If a boat is seen before and after a time, its velocity is the mean of both differences, each weighted by the
    /// other one's time step. This is exact for a constant acceleration. At the ends of a track differences are
    /// one-sided. Steps longer than `longest_s` or faster than `fastest_cm_s` give no difference; the fast ones are
    /// counted. Rows without a difference are NaN.
    pub fn velocities(&self, times_s: &[f64], longest_s: f64, fastest_cm_s: f64) -> (Self, usize) {
        let (mut broken, rows) = (0, &self.rows);
        let mut step = |row: usize| {
            let (before, after) = (row.checked_sub(self.boats)?, row);
            let time_s = times_s.get(after)? - times_s[before];
            let (from, to) = (rows[before], rows[after]);
            let velocity = (to.position - from.position) * time_s.recip();
            let slope = Pose::new(velocity.x, velocity.y, (to.heading - from.heading) / time_s);
            if !slope.is_finite() || time_s > longest_s {
                return None;
            }
            let is_fast = velocity.norm_squared() > fastest_cm_s * fastest_cm_s;
            broken += usize::from(is_fast);
            (!is_fast).then_some((slope, time_s))
        };
        let steps: Vec<_> = (0..rows.len() + self.boats).map(&mut step).collect();
        let mean = |row: usize| match (steps[row], steps[row + self.boats]) {
            (Some((a, short)), Some((b, long))) => {
                let share = long / (short + long);
                let mix = |x: f64, y: f64| x * share + y * (1.0 - share);
                Pose::new(
                    mix(a.position.x, b.position.x),
                    mix(a.position.y, b.position.y),
                    mix(a.heading, b.heading),
                )
            }
            (Some((only, _)), None) | (None, Some((only, _))) => only,
            (None, None) => Pose::new(f64::NAN, f64::NAN, f64::NAN),
        };
        let means = (0..rows.len()).map(mean).collect();
        (Self::new(means, self.boats), broken)
    }
}
