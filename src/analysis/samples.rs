//! Boats at many times, some of which may not be there: tracks of robots and animals have gaps.

use super::quantities::{RECORDED, Recorded, recorded};
use crate::error::Result;
use crate::geometry::{HullPose, Pose, Velocity};

/// Rows of three numbers, poses or velocities, of equally many boats at each time. Rows with a number that is not
/// finite stand for boats that are not there.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    rows: Vec<Pose>,
    boats: usize,
}

impl Samples {
    /// Of rows [x, y, heading], or [x velocity, y velocity, angular velocity], time after time.
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

    /// The rows of one time after another.
    pub fn each(&self) -> impl Iterator<Item = &[Pose]> {
        self.rows.chunks_exact(self.boats)
    }

    /// The boats that are there, one time after another.
    pub fn present(&self) -> impl Iterator<Item = Vec<Pose>> {
        self.each()
            .map(|rows| rows.iter().filter(|row| row.is_finite()).copied().collect())
    }

    /// The recorded quantities, at each time, of the boats that have both a pose and a velocity; NaN where there is
    /// none.
    ///
    /// # Errors
    /// Those of [`recorded`].
    pub fn recorded(&self, velocities: &Self) -> Result<Vec<Recorded>> {
        let velocity = |row: &Pose| Velocity::new(row.position.x, row.position.y, row.heading);
        let mut hulls = Vec::new();
        let times = self.each().zip(velocities.each());
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
}
