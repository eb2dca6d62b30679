//! Steps 1–6 of the paper's appendix, taken literally.
//!
//! Poses advance with the *old* velocities. If no overlap then exceeds the tolerance, these poses are
//! kept and velocities gain dt·a (eq. A.3). Otherwise the poses are projected to linearized gaps ≥ 0
//! (eq. A.4) and *every* boat's velocity becomes displacement/dt (eq. A.5): a step with a contact loses
//! the accelerations of all boats.

use super::moreau::explicit_velocities;
use super::state::Integrator;
use super::substep::Substep;
use crate::clock::seconds;
use crate::contact::{Motion, NotTaken};

/// Overlap in cm that is accepted at any tolerance. A solver's residual of 1e-10 cm/s leaves less in a substep, even in a
/// row of boats.
const ROUNDING: f64 = 1e-10;

/// One step of the appendix.
pub(super) fn step(flock: &mut Integrator, substep: &Substep) -> Result<(), NotTaken> {
    let dt = seconds(substep.length);
    flock.step_length_s = dt;
    flock.draw_substep_noise(substep);
    flock.fill_drives(substep, dt);
    explicit_velocities(flock, dt);
    let divisibility = flock.divisibility(dt);
    let (contacts, statistics) = (&mut flock.contacts, &mut flock.statistics);
    let (poses, velocities) = (&mut flock.poses, &flock.velocities);
    // The displacement that minimizes (A.4) is dt times the velocity nearest to the old one.
    let has_contacts = contacts.find(poses, &mut flock.boats, velocities, dt, statistics);
    let allowed = flock.parameters.overlap_tolerance_cm.max(ROUNDING);
    if has_contacts && contacts.overlaps_after(poses, velocities, dt, allowed) {
        let motion = Motion {
            poses,
            hulls: &flock.boats,
            // Eq. (A.4) has linear gaps.
            before: None,
            free: velocities,
            inertia: &flock.inertia,
            dt,
        };
        contacts.resolve(&motion, divisibility, statistics)?;
        std::mem::swap(&mut flock.velocities, &mut contacts.solver.velocities);
        flock.move_water(dt);
        flock.drift(dt);
        return Ok(());
    }
    if contacts.detector.moves_too_far(velocities, dt) {
        return Err(NotTaken::TooLong);
    }
    contacts.clear_warm_start();
    flock.move_water(dt);
    flock.drift(dt);
    flock.velocities.copy_from_slice(&flock.free);
    Ok(())
}
