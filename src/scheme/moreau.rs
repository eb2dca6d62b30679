//! Semi-implicit Euler with contacts in the velocities (Moreau's time stepping): first order.

use crate::dynamics::{Dynamics, Substep};
use crate::phase_schedule::seconds;

/// Free velocities by explicit Euler, contacts on them, then poses with the *new* velocities. Returns
/// whether the substep was taken: not if it is too long for its contacts.
pub fn moreau(flock: &mut Dynamics, substep: &Substep) -> bool {
    let dt = seconds(substep.length);
    flock.draw_step_kicks(substep);
    flock.fill_drives(substep);
    explicit_velocities(flock, dt);
    if flock.settle_contacts(substep).is_none() {
        return false;
    }
    flock.kick_s = dt;
    flock.drift(dt);
    true
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
