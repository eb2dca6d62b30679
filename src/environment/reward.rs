//! The reward: named terms, each larger if leaders lead better, and their weights.

use super::credit::LeaderCredit;
use super::observation::{FlockView, speed_scale_cm_s};
use crate::analysis::OrderParameters;
use crate::by_name;
use crate::error::{FlockError, Result};
use crate::geometry::LapFrame;
use crate::parameters::{FlockParameters, Kind, Setting, Target, Value, named_choice, wrong_kind};

named_choice! {
    /// A term of the reward.
    pub enum RewardTerm ("reward") {
        /// psi_o*cos(phi_o - phi_target) of the normal boats, in [-1, 1]; the same for all leaders with the same target
        SignedOrder = "signed_order",
        /// mean tangential velocity of the normal boats towards the target over the preferred speed; the same for all
        /// leaders with the same target
        TangentialVelocity = "tangential_velocity",
        /// the leader's own tangential velocity towards the target over the preferred speed
        LeaderVelocity = "leader_velocity",
        /// minus the square of the leader's own rudder, in [-1, 0]
        RudderEffort = "rudder_effort",
        /// minus psi_o*max(cos(phi_o), 0)*max(1 - psi_v/preferred speed, 0), in [-1, 0]; the same for all leaders
        Jam = "jam",
        /// tangential momentum that the leader's contacts gave to normal boats towards the target, sum of
        /// impulse*(normal*tangent) over the step's length, in cm/s^2; 0 if contact_push, contact_alignment
        /// and touched_order all have the weight 0
        ContactPush = "contact_push",
        /// angular velocity that the leader's contacts gave to normal boats, each times the sine of the angle that the
        /// boat has to turn to head along the target, over the step's length, in rad/s^2; 0 in the same case as contact_push
        ContactAlignment = "contact_alignment",
        /// sum over normal boats of cos(d) - cos(d + a), where d is the boat's angle to the target's tangent and a the
        /// angle by which the leader's contacts turned it: eq. (9) damps the spin that they gave, and the angle decays to
        /// 1/e in 4 s; 0 in the same case as contact_push
        TouchedOrder = "touched_order",
    }
}

/// Number of terms.
pub const TERMS: usize = RewardTerm::ALL.len();

/// The value of each term, in the order of [`RewardTerm::ALL`].
pub type RewardTerms = [f64; TERMS];

impl RewardTerm {
    /// Pairs of a term's name and its value.
    pub(super) fn named(terms: &RewardTerms) -> impl ExactSizeIterator<Item = (&'static str, f64)> {
        Self::ALL.iter().map(|term| term.name()).zip(*terms)
    }

    /// Whether the term needs at least one normal boat.
    pub(crate) fn needs_normal_boats(self) -> bool {
        matches!(
            self,
            Self::SignedOrder | Self::TangentialVelocity | Self::Jam
        ) || self.is_credit()
    }

    /// Whether the term is computed from the leader's contacts, which are recorded only if such a term has a weight.
    pub(crate) fn is_credit(self) -> bool {
        matches!(
            self,
            Self::ContactPush | Self::ContactAlignment | Self::TouchedOrder
        )
    }
}

/// The stored form of terms: by name, 0 if one is missing.
pub(super) mod stored_terms {
    use super::{RewardTerm, RewardTerms, by_name};

    pub(in super::super) fn serialize<S: serde::Serializer>(
        terms: &RewardTerms,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        by_name::write(RewardTerm::named(terms), serializer)
    }

    pub(in super::super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        deserializer: D,
    ) -> Result<RewardTerms, D::Error> {
        let mut terms = RewardTerms::default();
        by_name::read(deserializer, "the terms of the reward", |name, value| {
            let term = name.parse::<RewardTerm>();
            term.map(|term| terms[term as usize] = value).is_ok()
        })?;
        Ok(terms)
    }
}

/// The stored form of all leaders' terms: for each term by name, a list of one value per leader.
pub(super) mod stored_rows {
    use super::{RewardTerm, RewardTerms, TERMS, by_name};

    pub(in super::super) fn serialize<S: serde::Serializer>(
        rows: &[RewardTerms],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let columns = RewardTerm::ALL.iter().map(|&term| {
            let column: Vec<f64> = rows.iter().map(|terms| terms[term as usize]).collect();
            (term.name(), column)
        });
        by_name::write(columns, serializer)
    }

    pub(in super::super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<RewardTerms>, D::Error> {
        let mut rows: Vec<RewardTerms> = Vec::new();
        let set_column = |name: &str, column: Vec<f64>| {
            let Ok(term) = name.parse::<RewardTerm>() else {
                return false;
            };
            rows.resize(rows.len().max(column.len()), [0.0; TERMS]);
            for (terms, value) in rows.iter_mut().zip(column) {
                terms[term as usize] = value;
            }
            true
        };
        by_name::read(deserializer, "the terms of the reward", set_column)?;
        Ok(rows)
    }
}

/// A weight for each term.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RewardWeights(#[serde(with = "stored_terms")] pub RewardTerms);

impl Default for RewardWeights {
    /// The signed order alone.
    fn default() -> Self {
        let mut weights = [0.0; TERMS];
        weights[RewardTerm::SignedOrder as usize] = 1.0;
        Self(weights)
    }
}

impl RewardWeights {
    /// Checks the weights for flocks with these parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for weights that are not finite, or that need a normal boat in a
    /// flock without any.
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        for (term, weight) in RewardTerm::ALL.iter().zip(self.0) {
            let value = format!("{}: {weight}", term.name());
            FlockError::unless(weight.abs() <= 1e6, "reward", &value, "-1e6 to 1e6")?;
            let has_normal_boats = parameters.n_leaders < parameters.n_boats;
            let is_accepted = has_normal_boats || weight == 0.0 || !term.needs_normal_boats();
            let accepted = "this term needs a normal boat: n_boats > n_leaders";
            FlockError::unless(is_accepted, "reward", value, accepted)?;
        }
        Ok(())
    }

    /// Whether a term from the leaders' contacts has a weight.
    pub(crate) fn need_credit(&self) -> bool {
        let mut weights = RewardTerm::ALL.iter().zip(self.0);
        weights.any(|(term, weight)| term.is_credit() && weight != 0.0)
    }

    /// The weighted sum of the terms.
    fn total(&self, terms: &RewardTerms) -> f64 {
        self.0
            .iter()
            .zip(terms)
            .map(|(weight, term)| weight * term)
            .sum()
    }
}

impl Setting for RewardWeights {
    const KIND: Kind = Kind::Map(RewardTerm::names);

    fn value(&self) -> Value {
        let weights = RewardTerm::named(&self.0);
        weights.filter(|(_, weight)| *weight != 0.0).collect()
    }

    /// Terms that the value does not name have the weight 0.
    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        let Value::Map(named_weights) = value else {
            let accepted = "a dictionary of weights, or a list of dictionaries, one per leader";
            return wrong_kind(name, accepted);
        };
        let mut weights = Self([0.0; TERMS]);
        for (term, weight) in named_weights {
            let term: RewardTerm = term.parse()?;
            weights.0[term as usize] = f64::from_value(name, weight)?;
        }
        Ok(weights)
    }
}

/// The weights of a flock's leaders.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Weights {
    /// The same for all leaders.
    One(RewardWeights),
    /// Weights for each leader. A flock with fewer leaders than others in its batch uses the first ones.
    Each(Vec<RewardWeights>),
}

impl Weights {
    /// The weights of each leader, or one entry for all leaders.
    fn all(&self) -> &[RewardWeights] {
        match self {
            Self::One(weights) => std::slice::from_ref(weights),
            Self::Each(weights) => weights,
        }
    }

    /// The weighted sum of a leader's terms.
    pub fn total(&self, leader: usize, terms: &RewardTerms) -> f64 {
        let weights = match self {
            Self::One(weights) => Some(weights),
            Self::Each(weights) => weights.get(leader),
        };
        weights.map_or(0.0, |weights| weights.total(terms))
    }

    /// Checks the weights for flocks with these parameters.
    ///
    /// # Errors
    /// As for [`RewardWeights::check`].
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        self.all()
            .iter()
            .try_for_each(|weights| weights.check(parameters))
    }

    /// Checks that a list has one entry for each leader. `leaders` is the largest number of leaders of a flock in the
    /// batch.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a shorter or longer list.
    pub(super) fn check_leaders(&self, leaders: usize) -> Result<()> {
        match self {
            Self::Each(weights) if weights.len() != leaders => {
                let value = format!("a list of {} weights", weights.len());
                let accepted = format!("one dictionary, or one for each of {leaders} leaders");
                Err(FlockError::parameter("reward", value, accepted))
            }
            _ => Ok(()),
        }
    }

    /// Whether a term from the leaders' contacts has a weight.
    pub(crate) fn need_credit(&self) -> bool {
        self.all().iter().any(RewardWeights::need_credit)
    }
}

impl Default for Weights {
    fn default() -> Self {
        Self::One(RewardWeights::default())
    }
}

impl Setting for Weights {
    const KIND: Kind = RewardWeights::KIND;

    fn value(&self) -> Value {
        match self {
            Self::One(weights) => weights.value(),
            Self::Each(weights) => Value::List(weights.iter().map(Setting::value).collect()),
        }
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::List(list) => {
                let weights = list.iter().map(|value| Setting::from_value(name, value));
                weights.collect::<Result<_>>().map(Self::Each)
            }
            _ => RewardWeights::from_value(name, value).map(Self::One),
        }
    }
}

/// The reward terms of one control step. Terms about the normal boats are computed once, those about a leader on
/// request.
#[derive(Debug, Clone, Copy)]
pub struct Reward {
    /// Target of leader 0.
    reference: Target,
    /// Terms about the normal boats, for the reference target.
    flock_terms: RewardTerms,
    /// One over the preferred speed, in s/cm.
    inverse_speed: f64,
}

impl Reward {
    /// The reward at the end of a control step. `view` must be the flock as it is, not as the camera shows it.
    pub fn new(parameters: &FlockParameters, view: &FlockView) -> Self {
        let inverse_speed = 1.0 / speed_scale_cm_s(parameters);
        let reference = view.targets.reference();
        Self {
            reference,
            flock_terms: flock_terms(view, reference, inverse_speed),
            inverse_speed,
        }
    }

    /// All terms of one leader, for its own target.
    pub fn terms(&self, view: &FlockView, leader: usize, credit: &LeaderCredit) -> RewardTerms {
        let frame = LapFrame::at(view.poses[leader].position);
        let clockwise_cm_s = frame.components(view.velocities[leader].linear).y;
        let target = view.targets.of(leader);
        let mut terms = if target == self.reference {
            self.flock_terms
        } else {
            flock_terms(view, target, self.inverse_speed)
        };
        terms[RewardTerm::LeaderVelocity as usize] =
            target.sign() * clockwise_cm_s * self.inverse_speed;
        terms[RewardTerm::RudderEffort as usize] = -(view.rudders[leader] * view.rudders[leader]);
        terms[RewardTerm::ContactPush as usize] = credit.push;
        terms[RewardTerm::ContactAlignment as usize] = credit.alignment;
        terms[RewardTerm::TouchedOrder as usize] = credit.touched_order;
        terms
    }
}

/// The terms about the normal boats, for a target; 0 if the flock has no normal boats. Terms about a leader are 0, too.
fn flock_terms(view: &FlockView, target: Target, inverse_speed: f64) -> RewardTerms {
    let mut terms = RewardTerms::default();
    if let Some(order) = view.order {
        let towards_target = target.sign() * libm::sin(order.phi_v);
        terms[RewardTerm::SignedOrder as usize] = order.signed_order(target);
        terms[RewardTerm::TangentialVelocity as usize] =
            order.psi_v * towards_target * inverse_speed;
        terms[RewardTerm::Jam as usize] = -jam(order, inverse_speed);
    }
    terms
}

/// Degree of jamming in [0, 1]: 1 if boats are aligned, point at the outer wall, and stand still.
fn jam(order: &OrderParameters, inverse_speed: f64) -> f64 {
    order.psi_o * libm::cos(order.phi_o).max(0.0) * (1.0 - order.psi_v * inverse_speed).max(0.0)
}
