//! Setting the poses, velocities and time of a flock.

use super::flock::{Flock, LATEST};
use crate::clock::{Ticks, seconds, ticks};
use crate::contact::{Contact, Partner};
use crate::error::{FlockError, Result};
use crate::geometry::{Pose, Velocity};
use crate::integrator::Integrator;
use crate::parameters::FlockParameters;

/// Poses and velocities of a flock's boats at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
    /// The flock's time in s.
    pub time_s: f64,
    /// Whether hulls may overlap by more than a hundredth of their radius. Contacts leave smaller overlaps.
    pub allow_overlap: bool,
}

impl Flock {
    /// A flock with given poses of its boats.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for parameters out of range, otherwise as for [`Self::set_state`].
    pub fn from_state(parameters: FlockParameters, seed: u64, state: &State) -> Result<Self> {
        parameters.check()?;
        let mut flock = Self::unplaced(parameters, seed);
        flock.set_state(
            &state.poses,
            &state.velocities,
            state.time_s,
            state.allow_overlap,
        )?;
        Ok(flock)
    }

    /// Largest overlap in cm of an accepted state. It is more than contacts leave, so that states taken from a flock are
    /// accepted.
    fn largest_overlap_cm(&self) -> f64 {
        0.01 * self.parameters.boat_radius_cm
    }

    /// Whether a boat's center is further than a hull's width from the water, as in the state of another pool.
    fn is_ashore(&self, pose: &Pose) -> bool {
        let (pool, width) = (self.parameters.pool, 2.0 * self.parameters.boat_radius_cm);
        let distance = libm::hypot(pose.position.x, pose.position.y);
        !(pool.inner_radius_cm - width..=pool.outer_radius_cm + width).contains(&distance)
    }

    /// Refuses the flock if a boat overlaps an obstacle by more than contacts leave.
    pub(super) fn refuse_overlapped_obstacles(&self) -> Result<()> {
        let allowed_cm = self.largest_overlap_cm();
        refuse_overlap(&mut self.integrator.clone(), allowed_cm, |contact| {
            matches!(contact.partner, Partner::Obstacle(_))
        })
    }

    /// Sets poses, velocities and time.
    ///
    /// # Errors
    /// [`FlockError::Shape`] for wrong lengths, [`FlockError::Parameter`] for numbers that are not
    /// finite or out of range, [`FlockError::Overlap`] for overlapping hulls unless allowed. The
    /// flock is unchanged then.
    pub fn set_state(
        &mut self,
        poses: &[Pose],
        velocities: &[Velocity],
        time_s: f64,
        allow_overlap: bool,
    ) -> Result<()> {
        self.check_boats(poses, velocities)?;
        let time = time_from(time_s)?;
        let mut integrator = self.integrator.clone();
        integrator.place(poses, velocities);
        if !allow_overlap {
            refuse_overlap(&mut integrator, self.largest_overlap_cm(), |_| true)?;
        }
        (self.integrator, self.time) = (integrator, time);
        Ok(())
    }

    /// Refuses a wrong number of boats, and poses and velocities out of range.
    fn check_boats(&self, poses: &[Pose], velocities: &[Velocity]) -> Result<()> {
        let n = self.parameters.n_boats;
        for (field, length) in [("pose", poses.len()), ("velocity", velocities.len())] {
            if length != n {
                return Err(FlockError::Shape {
                    field,
                    found: format!("({length}, 3)"),
                    expected: format!("({n}, 3)"),
                });
            }
        }
        let accepted = "finite numbers from -1e9 to 1e9";
        if let Some(boat) = poses.iter().position(|pose| !pose.is_in_range()) {
            let Pose { position, heading } = poses[boat];
            let value = format!("[{}, {}, {heading}] of boat {boat}", position.x, position.y);
            return Err(FlockError::parameter("pose", value, accepted));
        }
        if let Some(boat) = poses.iter().position(|pose| self.is_ashore(pose)) {
            let Pose { position, .. } = poses[boat];
            let value = format!("[{}, {}] of boat {boat}", position.x, position.y);
            let accepted = "a center in the water, or within a hull's width of it";
            return Err(FlockError::parameter("pose", value, accepted));
        }
        if let Some(boat) = velocities.iter().position(|v| !v.is_in_range()) {
            let Velocity { linear, angular } = velocities[boat];
            let value = format!("[{}, {}, {angular}] of boat {boat}", linear.x, linear.y);
            return Err(FlockError::parameter("velocity", value, accepted));
        }
        Ok(())
    }
}

/// A checked time in ticks.
fn time_from(time_s: f64) -> Result<Ticks> {
    let is_time = time_s >= 0.0 && time_s <= seconds(LATEST);
    let accepted = "a finite time of at least 0 s, at most 1e9 s";
    FlockError::unless(is_time, "time_s", time_s, accepted)?;
    Ok(ticks(time_s))
}

/// Refuses boats whose selected contacts overlap by more than `allowed_cm`.
fn refuse_overlap(
    integrator: &mut Integrator,
    allowed_cm: f64,
    is_selected: impl Fn(&Contact) -> bool,
) -> Result<()> {
    let mut contacts = Vec::new();
    integrator
        .contacts
        .detector
        .detect(&integrator.boats, 0.0, &mut contacts);
    // This check must leave no neighbor list to the next substep.
    integrator.contacts.forget();
    let deepest = contacts
        .iter()
        .filter(|contact| is_selected(contact))
        .min_by(|a, b| a.gap.gap.total_cmp(&b.gap.gap));
    match deepest {
        Some(contact) if contact.gap.gap < -allowed_cm => Err(FlockError::Overlap {
            what: match contact.partner {
                Partner::Boat(other) => format!("boats {} and {other}", contact.boat),
                Partner::OuterWall => format!("boat {} and the outer wall", contact.boat),
                Partner::InnerWall => format!("boat {} and the inner wall", contact.boat),
                Partner::Obstacle(number) => {
                    let obstacle = integrator.parameters.obstacle_name(number as usize);
                    format!("boat {} and {obstacle}", contact.boat)
                }
            },
            overlap_cm: -contact.gap.gap,
        }),
        _ => Ok(()),
    }
}
