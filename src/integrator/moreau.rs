//! Semi-implicit Euler with contacts in the velocities (Moreau's time stepping): first order.

use super::state::Integrator;
use super::substep::Substep;
use crate::clock::seconds;
use crate::contact::NotTaken;

/// Explicit Euler gives free velocities, contacts change them, and poses move with the *new* velocities.
pub(super) fn step(flock: &mut Integrator, substep: &Substep) -> Result<(), NotTaken> {
    let dt = seconds(substep.length);
    flock.draw_substep_noise(substep);
    flock.fill_drives(substep, dt);
    explicit_velocities(flock, dt);
    flock.solve_contacts(substep)?;
    flock.step_length_s = dt;
    flock.move_water(dt);
    flock.drift(dt);
    Ok(())
}

/// Fills `free` with velocities after an explicit Euler step.
pub(super) fn explicit_velocities(flock: &mut Integrator, dt: f64) {
    let motion = &flock.motion;
    let boats = flock.velocities.iter().zip(&flock.boats).zip(&flock.drives);
    let free =
        boats.map(|((velocity, boat), drive)| motion.explicit(velocity, boat.axis, drive, dt));
    flock.free.clear();
    flock.free.extend(free);
}
