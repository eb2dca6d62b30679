//! Leapfrog: velocities live in the middle of substeps, poses at their ends. Second order while
//! contacts persist.
//!
//! A kick at time t_n takes the velocity from the middle of the last substep to the middle of the
//! next. Each half of the kick has the length, phase and rudder of its substep. The first kick after
//! a state was set has only its second half.

use super::phase_schedule::Phase;
use super::state::Integrator;
use super::substep::{LastSubstep, Steering, Substep};
use crate::clock::seconds;
use crate::contact::{InverseInertia, NotTaken};
use crate::geometry::{Vec2, Velocity};

/// Kicks below this fraction of `dt_s` do not reveal the force of contacts: impulses that close small overlaps do not
/// shrink with the kick. The contact force of an earlier kick is used instead.
const SHORTEST_KICK: f64 = 0.25;

/// One kick and one drift.
pub(super) fn step(flock: &mut Integrator, substep: &Substep) -> Result<(), NotTaken> {
    let kick_half_ticks = flock.last.length + substep.length;
    let kick = 0.5 * seconds(kick_half_ticks);
    let start_half_ticks = 2 * substep.start - flock.last.length.min(2 * substep.start);
    let end_half_ticks = 2 * substep.start + substep.length;
    flock.draw_noise(substep.start, start_half_ticks, end_half_ticks);
    flock.fill_drives(substep, 0.5 * kick);
    blend_drives(flock, substep);
    center_water(flock, kick);
    centered_velocities(flock, kick);

    let dt = seconds(substep.length);
    let has_contacts = flock.solve_contacts(substep)?;
    let persistent = &mut flock.last.persistent_acceleration;
    if !has_contacts {
        persistent.clear();
    } else if kick >= SHORTEST_KICK * flock.parameters.dt_s {
        persistent.clear();
        persistent.resize(flock.poses.len(), Vec2::zeros());
        flock
            .contacts
            .add_persistent_acceleration(&flock.inertia, kick, persistent);
    }
    flock.step_length_s = kick;
    flock.move_water(kick);
    flock.drift(dt);
    remember_substep(flock, substep);
    Ok(())
}

/// Replaces preferred speed and rudder by their means over the kick if they changed since the last substep.
fn blend_drives(flock: &mut Integrator, substep: &Substep) {
    let last_phase = Phase::ALL[flock.last.phase];
    // Moved out of `flock` while its drives change, and back below.
    let last_rudder = std::mem::take(&mut flock.last.rudder);
    let same_steering = match (substep.steering, &last_rudder) {
        (Steering::Law, None) => true,
        (Steering::Held(now), Some(then)) => now == then,
        _ => false,
    };
    if flock.last.length > 0 && !(same_steering && last_phase == substep.phase) {
        let steering = last_rudder.as_deref().map_or(Steering::Law, Steering::Held);
        let last_share = flock.last.length as f64 / (flock.last.length + substep.length) as f64;
        for boat in 0..flock.drives.len() {
            let earlier_speed = flock.preferred_speed(boat, last_phase);
            let earlier_rudder = flock.rudder(boat, steering);
            let drive = &mut flock.drives[boat];
            drive.preferred_speed += last_share * (earlier_speed - drive.preferred_speed);
            drive.rudder += last_share * (earlier_rudder - drive.rudder);
        }
    }
    flock.last.rudder = last_rudder;
}

/// Replaces the water's velocity in `drives` by that in the middle of the kick. If it followed from the velocities at the
/// kick's start, the scheme would be of first order.
fn center_water(flock: &mut Integrator, kick: f64) {
    flock.fill_water(0.5 * kick, |flock, boat| {
        let (velocity, axis) = (flock.velocities[boat].linear, flock.boats[boat].axis);
        let drive = &flock.drives[boat];
        let free = flock.motion.centered_change(velocity, axis, drive, kick);
        velocity + (free + persistent_change(&flock.last, boat, kick)) * 0.5
    });
}

/// Change of a boat's velocity over a kick by persistent contacts.
fn persistent_change(last: &LastSubstep, boat: usize, kick: f64) -> Vec2 {
    let accelerations = &last.persistent_acceleration;
    // `get` would compare a pointer, too, for every boat.
    if boat < accelerations.len() {
        accelerations[boat] * kick
    } else {
        Vec2::zeros()
    }
}

/// Fills `free` and `inertia` over a kick.
fn centered_velocities(flock: &mut Integrator, kick: f64) {
    let gyration = flock.parameters.gyration_radius_cm;
    let inverse_square = 1.0 / (gyration * gyration);
    let Integrator {
        free,
        inertia,
        velocities,
        boats,
        drives,
        motion,
        last,
        ..
    } = flock;
    // A local copy, so that the compiler knows that no write below changes it.
    let motion = *motion;
    let linear = motion.linear_mobility(kick);
    free.resize(drives.len(), Velocity::default());
    let results = free.iter_mut().zip(inertia).enumerate();
    let boats = velocities.iter().zip(&*boats).zip(&*drives);
    for ((boat, (free, inertia)), ((velocity, hull), drive)) in results.zip(boats) {
        let change = persistent_change(last, boat, kick);
        let result = motion.centered(velocity, hull.axis, drive, change, kick);
        *free = result.velocity;
        *inertia = InverseInertia {
            linear,
            angular: inverse_square * result.angular_mobility,
        };
    }
}

fn remember_substep(flock: &mut Integrator, substep: &Substep) {
    let last = &mut flock.last;
    last.length = substep.length;
    last.phase = substep.phase.index();
    match substep.steering {
        Steering::Law => last.rudder = None,
        Steering::Held(commands) => {
            let last_commands = last.rudder.get_or_insert_default();
            last_commands.clear();
            last_commands.extend_from_slice(commands);
        }
    }
}
