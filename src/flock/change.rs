//! Changes of a flock during a run: of its target, or of all parameters.

use super::flock::Flock;
use crate::error::Result;
use crate::geometry::{Hull, Pose, Vec2};
use crate::parameters::{FlockParameters, Pool, Targets};

/// A change of a flock during a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// The direction that all leaders follow from now on, or one direction per leader.
    Target(Targets),
    /// The parameters from now on. Boats keep their headings and velocities, water with inertia keeps its speed, and
    /// statistics go on. If the pool changes, each boat keeps its angle about the center and its relative distance
    /// between the walls. It is an error if a boat then overlaps an obstacle.
    Parameters(Box<FlockParameters>),
}

impl Flock {
    /// Applies a change now. New parameters restart the random streams from the flock's seeds.
    ///
    /// # Errors
    /// As for [`Flock::new`] and [`Flock::set_state`]; the flock is unchanged then.
    pub fn change(&mut self, change: &Change) -> Result<()> {
        match change {
            Change::Target(target) => self.set_target(target.clone())?,
            Change::Parameters(parameters) => {
                let poses =
                    poses_in_new_pool(self.poses(), self.parameters().pool, parameters.pool);
                let mut changed = self.with_parameters(FlockParameters::clone(parameters))?;
                changed.branch(self.noise_seed());
                // In a smaller pool hulls may overlap a little; the contact solver moves them apart.
                let allow_overlap = true;
                changed.set_state(&poses, self.velocities(), self.time_s(), allow_overlap)?;
                changed.integrator.keep_water(self.integrator.water_cm_s);
                changed.integrator.statistics = self.integrator.statistics;
                if !self.parameters().has_same_water(parameters) {
                    changed.refuse_overlapped_obstacles()?;
                }
                *self = changed;
            }
        }
        Ok(())
    }

    /// A flock with this seed and other parameters, whose poses are still to be set. Other hulls or another water are
    /// refused if boats cannot be placed at random.
    fn with_parameters(&self, parameters: FlockParameters) -> Result<Self> {
        let fits_alike = self.parameters().has_same_water(&parameters)
            && Hull::new(self.parameters()) == Hull::new(&parameters);
        if !fits_alike {
            return Self::new(parameters, self.seed());
        }
        // Present boats fit, though perhaps so tightly that no random placement would succeed.
        parameters.check()?;
        Ok(Self::unplaced(parameters, self.seed()))
    }
}

/// Moves boats along the radius into a new pool. Each boat keeps its relative distance between the walls. A boat at the
/// center has the polar angle 0.
fn poses_in_new_pool(poses: &[Pose], old: Pool, new: Pool) -> Vec<Pose> {
    let mut poses = poses.to_vec();
    if old == new {
        return poses;
    }
    let width = |pool: Pool| pool.outer_radius_cm - pool.inner_radius_cm;
    for Pose { position, .. } in &mut poses {
        let radius = libm::hypot(position.x, position.y);
        let relative_distance = (radius - old.inner_radius_cm) / width(old);
        let new_radius = new.inner_radius_cm + relative_distance * width(new);
        if radius > 0.0 {
            *position *= new_radius / radius;
        } else {
            *position = Vec2::new(new_radius, 0.0);
        }
    }
    poses
}
