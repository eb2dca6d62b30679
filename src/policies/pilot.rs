//! The pilot, which steers a flock's leaders by a law.

use super::Law;
use crate::clock::whole_steps;
use crate::contact::KeepGoing;
use crate::environment::LARGEST_LEAN;
use crate::environment::observation::{CourseView, FlockView, LeanFeatures};
use crate::error::Result;
use crate::flock::{Flock, Pause, Real, Recorder};
use crate::parameters::FlockParameters;

/// Steers the leaders of one flock by a law, once per control step.
#[derive(Debug, Clone)]
pub struct Pilot {
    law: Law,
    /// Number of control steps from one decision to the next.
    steps_per_decision: u32,
    /// Number of control steps that the present decision has steered; 0: a decision is due.
    steps_steered: u32,
    /// Angle in rad by which each leader's heading leans outward. A law that chooses rudders stores each leader's rudder
    /// instead. It keeps its sign if the target changes before the next decision.
    leans: Vec<f64>,
    views: Views,
}

/// Readers of courses and lean features, for flocks with these parameters.
#[derive(Debug, Clone)]
struct Views {
    parameters: FlockParameters,
    courses: CourseView,
    features: Option<LeanFeatures>,
}

impl Views {
    fn new(law: &Law, parameters: &FlockParameters) -> Result<Self> {
        let features = law.leaning().map(|law| Some(law.pool.as_str()));
        let features = features.map(|pool| LeanFeatures::standardized(parameters, pool));
        Ok(Self {
            courses: CourseView::new(parameters)?,
            features: features.transpose()?,
            parameters: parameters.clone(),
        })
    }
}

impl Pilot {
    /// A pilot for a flock with these checked parameters. `control_hz` is the number of control steps per second.
    ///
    /// # Errors
    /// [`crate::FlockError::Parameter`] for a law that [`Law::check`] refuses, for [`Law::EverySubstep`], and for a law
    /// whose decisions are not a whole number of control steps apart.
    pub fn new(law: Law, parameters: &FlockParameters, control_hz: f64) -> Result<Self> {
        law.check_reads_observations()?;
        law.check()?;
        let period_s = law.leaning().and_then(|law| law.decision_period_s);
        let steps_per_decision = period_s.map_or(Ok(1), |period_s| {
            whole_steps("decision_period_s", period_s, control_hz, "control steps")
        });
        Ok(Self {
            steps_per_decision: steps_per_decision?,
            steps_steered: 0,
            leans: vec![0.0; parameters.n_leaders],
            views: Views::new(&law, parameters)?,
            law,
        })
    }

    /// The leaders' rudders for the control step that starts now, positive counter-clockwise.
    ///
    /// # Errors
    /// As for [`Self::new`], if the flock's parameters have changed.
    pub fn rudders(&mut self, flock: &Flock) -> Result<Vec<f64>> {
        if *flock.parameters() != self.views.parameters {
            self.views = Views::new(&self.law, flock.parameters())?;
        }
        let features = self.views.features.as_ref();
        let order = features.and_then(|_| flock.order_parameters(Flock::WITHOUT_LEADERS).ok());
        let view = FlockView::new(flock, &[], order.as_ref());
        if self.steps_steered == 0 {
            self.decide(&view);
        }
        self.steps_steered = (self.steps_steered + 1) % self.steps_per_decision;
        let chooses_rudders = self.law.leaning().is_some_and(|law| law.gains.is_none());
        let leans = self.leans.iter().enumerate();
        let rudders = leans.map(|(leader, &lean)| {
            if chooses_rudders {
                return lean;
            }
            let course = self.views.courses.course(&view, leader, lean);
            self.law.rudder(&course)
        });
        Ok(rudders.collect())
    }

    /// Replaces the leans (or rudders), if the law is a leaning law.
    fn decide(&mut self, view: &FlockView) {
        if let (Some(law), Some(features)) = (self.law.leaning(), &mut self.views.features) {
            for (leader, lean) in self.leans.iter_mut().enumerate() {
                let action = f64::from(law.action(&features.observed(view, leader)));
                *lean = match law.gains {
                    Some(_) => LARGEST_LEAN * action,
                    // The law chooses rudders for a clockwise target.
                    None => view.targets.of(leader).sign() * action,
                };
            }
        }
    }

    /// Sets the angles in rad, wrapped or not, by which the leaders' headings lean outward from their targets'
    /// tangents. A leaning law replaces them at its next decision.
    pub fn lean_to(&mut self, leans: impl IntoIterator<Item = f64>) {
        for (lean, new) in self.leans.iter_mut().zip(leans) {
            *lean = new;
        }
    }

    /// Continues a run until about `boat_substeps` (substeps times boats) are done, or to its end. Steers at each control
    /// step.
    ///
    /// # Errors
    /// As for [`Recorder::run`] and [`Self::rudders`].
    pub fn run<T: Real>(
        &mut self,
        recorder: &mut Recorder<T>,
        keep_going: KeepGoing,
        boat_substeps: u64,
    ) -> Result<Pause> {
        let mut work_left = boat_substeps;
        loop {
            let substeps_before = recorder.flock().statistics().substeps;
            let pause = recorder.run(keep_going, work_left)?;
            if pause != Pause::Control {
                return Ok(pause);
            }
            recorder.steer(self.rudders(recorder.flock())?)?;
            let substeps = recorder.flock().statistics().substeps - substeps_before;
            let boats = recorder.flock().parameters().n_boats as u64;
            work_left = work_left.saturating_sub(substeps * boats);
        }
    }
}
