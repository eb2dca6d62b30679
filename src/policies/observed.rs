//! Laws evaluated from what leaders observe.

use super::Law;
use crate::environment::LARGEST_LEAN;
use crate::environment::observation::{Block, CourseReader, LEAN_FEATURES, ObservationLayout};
use crate::error::{FlockError, Result};

/// A law for observations of one layout.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedLaw {
    law: Law,
    size: usize,
    /// `None` if the law's actions are rudders, or leans that the environment steers to.
    courses: Option<CourseReader>,
    /// Index of the first lean feature, if the law reads them.
    features: Option<usize>,
}

impl ObservedLaw {
    /// A law for observations of a checked layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if a block that the law reads is switched off, and for the law at every substep, which
    /// reads no observations.
    pub fn new(law: Law, layout: &ObservationLayout) -> Result<Self> {
        law.check_reads_observations()?;
        law.check()?;
        let features = layout.offset(Block::LeanFeatures);
        let is_met = features.is_some() || law.leaning().is_none();
        let accepted = "a leaning law reads this block; switch it on";
        FlockError::unless(is_met, "observation", "lean_features: off", accepted)?;
        let leaning = law.leaning();
        let acts =
            leaning.is_some_and(|law| law.decision_period_s.is_some() || law.gains.is_none());
        let courses = (!acts).then(|| CourseReader::new(layout)).transpose()?;
        Ok(Self {
            size: layout.size(),
            courses,
            features: features.filter(|_| leaning.is_some()),
            law,
        })
    }

    /// Size of an observation.
    pub fn observation_size(&self) -> usize {
        self.size
    }

    /// The action for one observation: a rudder, or a lean if the law holds leans. It is mirrored if the observation
    /// is. It depends on nothing else, such as other observations of a batch.
    pub fn action(&self, observation: &[f32]) -> f64 {
        let lean = self.law.leaning().zip(self.features);
        let lean = lean.map_or(0.0, |(law, index)| {
            f64::from(law.action(&observation[index..index + LEAN_FEATURES]))
        });
        match &self.courses {
            Some(courses) => {
                let course = courses.course(observation, LARGEST_LEAN * lean);
                self.law.rudder(&course)
            }
            None => lean,
        }
    }
}
