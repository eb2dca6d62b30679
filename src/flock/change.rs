//! Changes of a flock while it moves: of its target, or of all parameters.

use super::flock::Flock;
use crate::error::Result;
use crate::geometry::Pose;
use crate::parameters::{FlockParameters, Pool, Targets};

/// A change of a flock at some time.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// The direction that all leaders follow from now on, or one direction per leader.
    Target(Targets),
    /// The parameters from now on. Boats keep their headings and velocities, and water with inertia keeps its speed. If
    /// the pool changes, each boat keeps its angle about the center and its relative distance between the walls. It is
    /// an error if a boat then overlaps an obstacle.
    Parameters(Box<FlockParameters>),
}

impl Flock {
    /// Changes the flock at this time. New parameters restart the random streams from the flock's seeds.
    ///
    /// # Errors
    /// As for [`Flock::new`] and [`Flock::set_state`]; the flock is unchanged then.
    pub fn change(&mut self, change: &Change) -> Result<()> {
        match change {
            Change::Target(target) => self.set_target(target.clone())?,
            Change::Parameters(parameters) => {
                let poses = moved(self.poses(), self.parameters().pool, parameters.pool);
                let mut next = Self::new(FlockParameters::clone(parameters), self.seed())?;
                next.branch(self.noise_seed());
                // A smaller pool may let hulls overlap a little; the contact solver moves them apart.
                next.set_state(&poses, self.velocities(), self.time_s(), true)?;
                next.integrator.keep_water(self.integrator.water_cm_s);
                if !self.parameters().has_same_water(parameters) {
                    next.refuse_overlapped_obstacles()?;
                }
                *self = next;
            }
        }
        Ok(())
    }
}

fn moved(poses: &[Pose], old: Pool, new: Pool) -> Vec<Pose> {
    let mut poses = poses.to_vec();
    if old == new {
        return poses;
    }
    let width = |pool: Pool| pool.outer_radius_cm - pool.inner_radius_cm;
    for Pose { position, .. } in &mut poses {
        let distance = libm::hypot(position.x, position.y);
        let share = (distance - old.inner_radius_cm) / width(old);
        *position *= (new.inner_radius_cm + share * width(new)) / distance;
    }
    poses
}
