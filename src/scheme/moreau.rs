//! Semi-implicit Euler with contacts in the velocities (Moreau's time stepping): first order.

use crate::dynamics::{Dynamics, Substep};
use crate::phase_schedule::seconds;

/// Free velocities by explicit Euler, contacts on them, then poses with the *new* velocities.
pub fn moreau(flock: &mut Dynamics, substep: &Substep) {
    let dt = seconds(substep.length);
    flock.draw_step_kicks(substep);
    flock.fill_drives(substep);
    explicit_velocities(flock, dt);
    flock.settle_contacts(dt);
    flock.kick_s = dt;
    flock.drift(dt);
}

/// Fills `free` with velocities after an explicit Euler step.
pub(super) fn explicit_velocities(flock: &mut Dynamics, dt: f64) {
    let Dynamics {
        free,
        velocities,
        boats,
        drives,
        motion,
        ..
    } = flock;
    free.clear();
    free.extend(
        velocities
            .iter()
            .zip(&*boats)
            .zip(&*drives)
            .map(|((velocity, boat), drive)| motion.explicit(velocity, boat.axis, drive, dt)),
    );
}
