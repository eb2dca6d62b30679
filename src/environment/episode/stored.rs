//! What is stored of an episode, and the episode made of it again.

use super::Episode;
use crate::environment::credit::ContactCredit;
use crate::environment::observation::{Camera, CameraState};
use crate::environment::reset::flock_from;
use crate::environment::statistics::{EpisodeStatistics, LeaderSums};
use crate::environment::{Averages, EnvSettings, EpisodeSchedule, Terms};
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;

/// What is stored of an episode.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct StoredEpisode<A = Averages, T = Terms, C = Option<ContactCredit>> {
    flock: Vec<u8>,
    schedule: EpisodeSchedule,
    rudders: Vec<f64>,
    camera: Option<CameraState>,
    terms: Vec<T>,
    statistics: EpisodeStatistics<A, T>,
    ended: bool,
    credit: C,
}

impl Episode {
    /// The episode, to be stored.
    pub(crate) fn stored(&self) -> StoredEpisode {
        StoredEpisode {
            flock: self.state.flock.snapshot(),
            schedule: self.state.schedule.clone(),
            rudders: self.state.rudders.clone(),
            camera: self.camera.as_ref().map(Camera::state),
            terms: self.terms.iter().copied().map(Terms).collect(),
            statistics: self.statistics,
            ended: self.ended,
            credit: self.credit.clone(),
        }
    }

    /// What is stored of its leaders since format 4.
    pub(crate) fn stored_leaders(&self) -> Vec<LeaderSums> {
        self.leader_sums.clone()
    }

    /// Puts back what [`Self::stored_leaders`] gave.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if it is of another number of leaders.
    pub(crate) fn restore_leaders(&mut self, stored: Vec<LeaderSums>) -> Result<()> {
        if stored.len() != self.leader_sums.len() {
            return Err(FlockError::Snapshot(
                "the state holds sums of other leaders".to_owned(),
            ));
        }
        self.leader_sums = stored;
        Ok(())
    }

    /// The episode that was stored, in an environment with these settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if it does not belong there.
    pub(crate) fn restored<A, T, C>(
        settings: &EnvSettings,
        parameters: &FlockParameters,
        stored: StoredEpisode<A, T, C>,
    ) -> Result<Self>
    where
        Averages: From<A>,
        Terms: From<T>,
        C: Into<Option<ContactCredit>>,
    {
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let flock = flock_from(&stored.flock, parameters)?;
        let credit: Option<ContactCredit> = stored.credit.into();
        let fits = stored.rudders.len() == leaders
            && stored.rudders.iter().all(|rudder| rudder.abs() <= 1.0)
            && stored.terms.len() == leaders
            && stored.schedule.steps == settings.episode.steps()
            && stored.schedule.bw_s == flock.parameters().bw_s
            && stored.schedule.targets() == flock.parameters().target
            && credit.is_some() == settings.reward.need_credit()
            && credit.as_ref().is_none_or(|each| each.fits(leaders, boats))
            && stored.camera.is_some() == settings.camera.is_active()
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
        episode.camera = stored.camera.map(|state| {
            let mut camera = Camera::unexposed(settings.camera, seed);
            camera.set_state(state, leaders);
            camera
        });
        let terms = stored.terms.into_iter();
        episode.terms = terms.map(|term| Terms::from(term).0).collect();
        episode.credit = credit;
        episode.statistics = stored.statistics.restored();
        episode.ended = stored.ended;
        Ok(episode)
    }
}
