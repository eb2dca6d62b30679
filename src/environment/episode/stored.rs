//! What is stored of an episode, and the episode made of it again.

use super::Episode;
use crate::environment::credit::ContactCredit;
use crate::environment::observation::{Camera, CameraState, Lens};
use crate::environment::reset::flock_from;
use crate::environment::statistics::{EpisodeStatistics, LeaderSums};
use crate::environment::{EnvSettings, EpisodeSchedule, RewardTerms};
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;

/// What is stored of an episode.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct StoredEpisode {
    flock: Vec<u8>,
    schedule: EpisodeSchedule,
    rudders: Vec<f64>,
    camera: Option<CameraState>,
    terms: Vec<RewardTerms>,
    statistics: EpisodeStatistics,
    leader_sums: Vec<LeaderSums>,
    ended: bool,
    credit: Option<ContactCredit>,
}

impl Episode {
    /// The episode, to be stored.
    pub(crate) fn stored(&self) -> StoredEpisode {
        StoredEpisode {
            flock: self.state.flock.snapshot(),
            schedule: self.state.schedule.clone(),
            rudders: self.state.rudders.clone(),
            camera: self.camera.as_ref().map(Camera::state),
            terms: self.terms.clone(),
            statistics: self.statistics,
            leader_sums: self.leader_sums.clone(),
            ended: self.ended,
            credit: self.credit.clone(),
        }
    }

    /// The episode that was stored, in an environment with these settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if it does not belong there.
    pub(crate) fn restored(
        settings: &EnvSettings,
        parameters: &FlockParameters,
        stored: StoredEpisode,
    ) -> Result<Self> {
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let flock = flock_from(&stored.flock, parameters)?;
        let lens = Lens::new(settings);
        let fits = stored.rudders.len() == leaders
            && stored.rudders.iter().all(|rudder| rudder.abs() <= 1.0)
            && stored.terms.len() == leaders
            && stored.schedule.steps == settings.steps()
            && stored.schedule.targets() == flock.parameters().target
            && stored.credit.is_some() == settings.reward.need_credit()
            && stored
                .credit
                .as_ref()
                .is_none_or(|each| each.fits(leaders, boats))
            && stored.camera.is_some() == lens.is_some()
            && stored
                .camera
                .as_ref()
                .is_none_or(|state| Camera::fits(state, boats));
        if !fits {
            return Err(FlockError::Snapshot(
                "the state holds an episode that this environment cannot have".to_owned(),
            ));
        }
        let seed = stored.schedule.flock_seed;
        let mut episode = Self::new(settings, stored.schedule, flock)?;
        episode.state.rudders = stored.rudders;
        episode.camera = lens.zip(stored.camera).map(|(lens, state)| {
            let mut camera = Camera::unexposed(lens, seed);
            camera.set_state(state, leaders);
            camera
        });
        episode.terms = stored.terms;
        episode.credit = stored.credit;
        episode.statistics = stored.statistics;
        if stored.leader_sums.len() != episode.leader_sums.len() {
            return Err(FlockError::Snapshot(
                "the state holds sums of other leaders".to_owned(),
            ));
        }
        episode.leader_sums = stored.leader_sums;
        episode.ended = stored.ended;
        Ok(episode)
    }
}
