//! The length of a flock's substeps: its changes during a run with the same noise, and the error that it causes.

use super::flock::Flock;
use crate::clock::Ticks;
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::geometry::rms_distance;
use crate::integrator::Steering;
use crate::parameters::{FlockParameters, Noise};

/// The error is the distance from a run with substeps this many times shorter. Substeps of half the length would not
/// show the error of an impact: it depends on when in a substep the impact happens, and may be as large in both runs.
const FINER: f64 = 8.0;
/// The shortest substep in s.
const SHORTEST_S: f64 = 1e-6;

impl Flock {
    /// Changes `dt_s` from now on. White noise keeps its paths: flocks made with the same parameters and seed get the
    /// same noise with any later step.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a step out of range; the flock is unchanged then.
    pub fn set_step(&mut self, dt_s: f64) -> Result<()> {
        let parameters = FlockParameters {
            dt_s,
            ..self.parameters.clone()
        };
        parameters.check()?;
        self.replace_step(dt_s);
        Ok(())
    }

    /// As [`Self::set_step`], for a step that was already checked.
    pub(super) fn replace_step(&mut self, dt_s: f64) {
        self.parameters.dt_s = dt_s;
        self.integrator.set_step(dt_s);
    }

    /// Advances as [`Self::advance`], and returns the error that the finite step caused: the [`rms_distance`] in cm to
    /// a run with substeps an eighth as long, from the same start and with the same noise paths. This takes nine times
    /// as long. Errors of successive advances do not add up: boats that press against a wall lose part of their errors,
    /// and impacts enlarge them.
    ///
    /// # Errors
    /// As for [`Self::advance`]; [`FlockError::Parameter`] for a step too short to be divided by 8, and for noise that
    /// depends on the step. The flock is unchanged then.
    pub fn advance_with_error(&mut self, duration_s: f64, rudder: Option<&[f64]>) -> Result<f64> {
        let end = self.end_of(duration_s)?;
        self.check_rudder(rudder)?;
        let steering = rudder.map_or(Steering::Law, Steering::Held);
        self.advance_to_with_error(&|| true, end, steering)
    }

    /// As [`Self::advance_with_error`], but to a time and with checked steering; calls `keep_going` now and then.
    ///
    /// # Errors
    /// As for [`Self::advance_to`] and [`Self::advance_with_error`].
    pub fn advance_to_with_error(
        &mut self,
        keep_going: KeepGoing,
        end: Ticks,
        steering: Steering,
    ) -> Result<f64> {
        let mut finer = self.with_finer_step()?;
        finer.advance_to(keep_going, end, steering)?;
        self.advance_to(keep_going, end, steering)?;
        let error = rms_distance(
            self.poses(),
            finer.poses(),
            self.parameters.gyration_radius_cm,
        );
        let worst = &mut self.integrator.statistics.worst_error_cm;
        *worst = worst.max(error);
        Ok(error)
    }

    /// A copy of the flock with substeps an eighth as long.
    fn with_finer_step(&self) -> Result<Self> {
        let p = &self.parameters;
        let has_path = p.noise_scheme == Noise::White || p.c4 == 0.0;
        let accepted = "\"white\", or c4 = 0: noise that is drawn for each step has no path that shorter steps could \
                        follow, so no error can be measured";
        FlockError::unless(has_path, "noise_scheme", p.noise_scheme.name(), accepted)?;
        let shortest = FINER * SHORTEST_S;
        let accepted = format!(
            "{shortest:e} s or more: the error is measured against substeps an eighth as long, of at least {SHORTEST_S:e} s"
        );
        FlockError::unless(p.dt_s >= shortest, "dt_s", p.dt_s, accepted)?;
        let mut finer = self.clone();
        finer.replace_step(p.dt_s / FINER);
        Ok(finer)
    }
}
