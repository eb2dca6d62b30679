//! The reward: named terms, each larger for better, and their weights.

use super::observation::{FlockView, speed_scale_cm_s};
use crate::analysis::OrderParameters;
use crate::error::{FlockError, Result};
use crate::geometry::LapFrame;
use crate::parameters::{FlockParameters, named_choice};

named_choice! {
    /// A term of the reward.
    pub enum RewardTerm ("reward") {
        /// Ψ_o·cos(φ_o − φ_target) of the normal boats, in [−1, 1].
        SignedOrder = "signed_order",
        /// Mean tangential velocity of the normal boats towards the target, over the preferred speed.
        TangentialVelocity = "tangential_velocity",
        /// The leader's own tangential velocity towards the target, over the preferred speed.
        LeaderVelocity = "leader_velocity",
        /// Minus the square of the leader's rudder, in [−1, 0].
        RudderEffort = "rudder_effort",
        /// Minus the jam: −Ψ_o·max(cos φ_o, 0)·max(1 − Ψ_v/preferred speed, 0), in [−1, 0].
        Jam = "jam",
    }
}

/// How many terms there are.
pub const TERMS: usize = RewardTerm::ALL.len();

/// The value of each term, in the order of [`RewardTerm::ALL`].
pub type RewardTerms = [f64; TERMS];

impl RewardTerm {
    /// Whether the term is about the normal boats, so that it needs at least one.
    pub(crate) fn needs_normal_boats(self) -> bool {
        matches!(
            self,
            Self::SignedOrder | Self::TangentialVelocity | Self::Jam
        )
    }

    /// In words, for documentation.
    pub fn description(self) -> &'static str {
        match self {
            Self::SignedOrder => {
                "psi_o*cos(phi_o - phi_target) of the normal boats, in [-1, 1]; the same for all leaders"
            }
            Self::TangentialVelocity => {
                "mean tangential velocity of the normal boats towards the target over the preferred \
                 speed; the same for all leaders"
            }
            Self::LeaderVelocity => {
                "the leader's own tangential velocity towards the target over the preferred speed"
            }
            Self::RudderEffort => "minus the square of the leader's own rudder, in [-1, 0]",
            Self::Jam => {
                "minus psi_o*max(cos(phi_o), 0)*max(1 - psi_v/preferred speed, 0), in [-1, 0]; the \
                 same for all leaders"
            }
        }
    }
}

/// A weight for each term.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RewardWeights(pub RewardTerms);

impl Default for RewardWeights {
    /// The signed order alone.
    fn default() -> Self {
        Self([1.0, 0.0, 0.0, 0.0, 0.0])
    }
}

impl RewardWeights {
    /// Checks the weights for flocks with these parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for weights that are not finite, or that need normal boats where
    /// there is none.
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        for (term, weight) in RewardTerm::ALL.iter().zip(self.0) {
            let value = format!("{}: {weight}", term.name());
            if weight.is_nan() || weight.abs() > 1e6 {
                return Err(FlockError::parameter("reward", value, "weights within 1e6"));
            }
            let normal = parameters.n_boats - parameters.n_leaders;
            if weight != 0.0 && term.needs_normal_boats() && normal == 0 {
                let accepted = "terms about the normal boats need n_boats > n_leaders";
                return Err(FlockError::parameter("reward", value, accepted));
            }
        }
        Ok(())
    }

    /// The weighted sum.
    pub fn total(&self, terms: &RewardTerms) -> f64 {
        self.0
            .iter()
            .zip(terms)
            .map(|(weight, term)| weight * term)
            .sum()
    }
}

/// The terms of one control step: those of the flock worked out once, those of a leader on request.
#[derive(Debug, Clone, Copy)]
pub struct Reward {
    flock: RewardTerms,
    inverse_speed: f64,
}

impl Reward {
    /// At the end of a control step; `order` is the true one, whatever leaders see.
    pub fn new(parameters: &FlockParameters, view: &FlockView) -> Self {
        let inverse_speed = 1.0 / speed_scale_cm_s(parameters);
        let mut flock = RewardTerms::default();
        if let Some(order) = view.order {
            let towards = view.target.sign() * order.phi_v.sin();
            flock[RewardTerm::SignedOrder as usize] = order.signed_order(view.target);
            flock[RewardTerm::TangentialVelocity as usize] = order.psi_v * towards * inverse_speed;
            flock[RewardTerm::Jam as usize] = -jam(order, inverse_speed);
        }
        Self {
            flock,
            inverse_speed,
        }
    }

    /// All terms for one leader.
    pub fn terms(&self, view: &FlockView, leader: usize) -> RewardTerms {
        let clockwise = LapFrame::at(view.poses[leader].position)
            .components(view.velocities[leader].linear)
            .y;
        let mut terms = self.flock;
        terms[RewardTerm::LeaderVelocity as usize] =
            view.target.sign() * clockwise * self.inverse_speed;
        terms[RewardTerm::RudderEffort as usize] = -view.rudders[leader].powi(2);
        terms
    }
}

/// How jammed the flock is, in [0, 1]: aligned, at the outer wall, and standing.
fn jam(order: &OrderParameters, inverse_speed: f64) -> f64 {
    order.psi_o * order.phi_o.cos().max(0.0) * (1.0 - order.psi_v * inverse_speed).max(0.0)
}
