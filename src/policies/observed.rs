//! Laws evaluated from what leaders observe.

use super::Law;
use crate::environment::LARGEST_LEAN;
use crate::environment::observation::{Block, CourseReader, LEAN_FEATURES, ObservationLayout};
use crate::error::{FlockError, Result};

/// A law for observations of one layout.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedLaw {
    law: Law,
    /// Size of an observation.
    size: usize,
    /// Reads a leader's course. `None` if the law does not need it: a leaning law may choose a rudder itself, or a lean that
    /// the environment steers to.
    courses: Option<CourseReader>,
    /// Index of the first lean feature in an observation, if the law reads lean features.
    first_feature: Option<usize>,
    /// Index of the target in an observation that is not mirrored, if the law chooses a rudder for a clockwise target.
    target: Option<usize>,
}

impl ObservedLaw {
    /// A law for observations of a checked layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if a block that the law reads is switched off, for a law that [`Law::check`] refuses, and
    /// for [`Law::EverySubstep`], which does not read observations.
    pub fn new(law: Law, layout: &ObservationLayout) -> Result<Self> {
        law.check_reads_observations()?;
        law.check()?;
        let leaning = law.leaning();
        let first_feature = layout.offset(Block::LeanFeatures);
        let has_block = first_feature.is_some() || leaning.is_none();
        let accepted = "a leaning law reads this block; switch it on";
        FlockError::unless(has_block, "observation", "lean_features: off", accepted)?;
        // A leaning law without gains chooses a rudder itself; one with a decision period, a held lean.
        let reads_course = leaning
            .is_none_or(|leaning| leaning.decision_period_s.is_none() && leaning.gains.is_some());
        let courses = reads_course.then(|| CourseReader::new(layout));
        let chooses_rudder = leaning.is_some_and(|leaning| leaning.gains.is_none());
        let target = layout.index(Block::Target, "target");
        let target = target.filter(|_| chooses_rudder && !layout.is_mirrored);
        let has_target = !chooses_rudder || layout.is_mirrored || target.is_some();
        let accepted = "without mirroring, the law reads this block; switch it on";
        FlockError::unless(has_target, "observation", "target: off", accepted)?;
        Ok(Self {
            target,
            size: layout.size(),
            courses: courses.transpose()?,
            first_feature: first_feature.filter(|_| leaning.is_some()),
            law,
        })
    }

    /// Size of an observation.
    pub fn observation_size(&self) -> usize {
        self.size
    }

    /// The action for one observation: a rudder, or a lean if the law holds leans. If the observation is mirrored, so is the
    /// action. The action does not depend on other observations.
    pub fn action(&self, observation: &[f32]) -> f64 {
        let leaning = self.law.leaning().zip(self.first_feature);
        // A lean over LARGEST_LEAN, or a rudder; 0 for laws that do not lean.
        let leaning_action = leaning.map_or(0.0, |(law, first)| {
            f64::from(law.action(&observation[first..first + LEAN_FEATURES]))
        });
        match &self.courses {
            Some(courses) => {
                let course = courses.course(observation, LARGEST_LEAN * leaning_action);
                self.law.rudder(&course)
            }
            None => {
                let sign = self.target.map_or(1.0, |index| observation[index].into());
                sign * leaning_action
            }
        }
    }
}
