//! The training: rounds of branches, and a step of the weights after each round.

use super::BranchSettings;
use super::branch::{Outcome, Pair, Task};
use super::regression::{Features, Matrix, SIZE, add_square, dot, product, solve_ridge};
use crate::boat::DampedLaw;
use crate::contact::KeepGoing;
use crate::environment::{ActionMode, LARGEST_LEAN};
use crate::error::{FlockError, Result};
use crate::parallel;
use crate::parameters::FlockParameters;
use crate::policies::LeaningLaw;
use crate::sealed_bytes::{Magic, seal, unseal};

/// First bytes of a stored training.
const MAGIC: Magic = *b"flocktr2";

/// State of a training between two rounds. In the sums, a factor `memory` per round makes earlier rounds count less.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct TrainingState {
    /// Weights before the first round and after each round.
    weights: Vec<Features>,
    /// Mean order of each round.
    orders: Vec<f64>,
    /// Sum of x xᵀ over branches, where x are the regressors.
    regressor_squares: Matrix,
    /// Sum of x·y over branches, where y is the order difference.
    regressor_products: Features,
    /// Sum over rounds of the mean g gᵀ, where g are the action slopes of an offset.
    slope_squares: Matrix,
    /// Number of rounds in `slope_squares`; earlier rounds count less here, too.
    rounds: f64,
    /// Number of branches in which a flock left an overlap deeper than the tolerance.
    unsolved: u64,
    /// Deepest overlap of any branch in cm.
    worst_overlap_cm: f64,
    /// The pairs before their next branches.
    pairs: Vec<Pair>,
}

impl TrainingState {
    /// Whether a stored state has finite numbers and fits a training with these numbers of pairs and of branches in an
    /// episode.
    fn fits(&self, pairs: usize, branches: usize) -> bool {
        let sums = self
            .regressor_squares
            .iter()
            .chain(&self.slope_squares)
            .chain([&self.regressor_products]);
        let numbers = sums.chain(&self.weights).flatten().chain(&self.orders);
        let mut numbers = numbers.chain([&self.rounds, &self.worst_overlap_cm]);
        numbers.all(|number| number.is_finite())
            && self.weights.len() == self.orders.len() + 1
            && self.pairs.len() == pairs
            && self
                .pairs
                .iter()
                .all(|pair| (1..=branches).contains(&pair.branches_left))
    }

    /// The weights after a step along the natural gradient.
    ///
    /// The gradient of the order comes from the regression. The root mean square change of the actions is `step` times
    /// the remaining fraction of the training.
    fn stepped_weights(&self, settings: &BranchSettings) -> Features {
        let products = &self.regressor_products;
        let gradient = solve_ridge(&self.regressor_squares, settings.ridge, products);
        let change = product(&self.slope_squares, &gradient);
        let mean_square_change = dot(&gradient, &change) / self.rounds;
        let finished_rounds = self.orders.len();
        let remaining = 1.0 - finished_rounds as f64 / settings.rounds() as f64;
        // The small number avoids a division by 0.
        let rms_change = mean_square_change.max(0.0).sqrt() + 1e-12;
        let rate = settings.step * remaining.max(0.0) / rms_change;
        let weights = &self.weights[finished_rounds];
        std::array::from_fn(|k| weights[k] + rate * gradient[k])
    }
}

/// Trains leaders whose leans or rudders are linear in the lean features.
///
/// In a round each pair of flocks runs one branch: both flocks start from the same state with the same noise, and their
/// leaders add opposite offsets to their actions. The difference of their orders is regressed on the offsets times the
/// action slopes. The coefficients say how much each weight raises the order, and the weights take a step in that
/// direction.
#[derive(Debug, Clone)]
pub struct Trainer {
    task: Task,
    state: TrainingState,
    /// Finished branches of the current round, with each pair's next state.
    finished: Vec<(Outcome, Pair)>,
}

impl Trainer {
    /// A training at its start. `seed` decides the offsets; the flocks have consecutive seeds from `first_seed` on.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn new(
        settings: BranchSettings,
        parameters: FlockParameters,
        seed: u64,
        first_seed: u64,
    ) -> Result<Self> {
        settings.check(&parameters)?;
        let task = Task {
            env_settings: settings.env_settings(),
            decisions: settings.decisions()?,
            settings,
            parameters,
            seed,
            first_seed,
        };
        let pairs = (0..task.settings.pairs).map(|number| task.pair(number));
        let state = TrainingState {
            weights: vec![[0.0; SIZE]],
            orders: Vec::new(),
            regressor_squares: [[0.0; SIZE]; SIZE],
            regressor_products: [0.0; SIZE],
            slope_squares: [[0.0; SIZE]; SIZE],
            rounds: 0.0,
            unsolved: 0,
            worst_overlap_cm: 0.0,
            pairs: pairs.collect(),
        };
        let trainer = Self {
            task,
            state,
            finished: Vec::new(),
        };
        trainer.law()?;
        Ok(trainer)
    }

    /// The settings.
    pub fn settings(&self) -> &BranchSettings {
        &self.task.settings
    }

    /// The flocks' parameters.
    pub fn parameters(&self) -> &FlockParameters {
        &self.task.parameters
    }

    /// Simulated time in hours, summed over all flocks: until now, and at the end of the training.
    pub fn flock_hours(&self) -> (f64, f64) {
        let settings = &self.task.settings;
        let fraction = self.finished.len() as f64 / settings.pairs as f64;
        let round_hours = settings.round_hours();
        (
            round_hours * (self.state.orders.len() as f64 + fraction),
            round_hours * settings.rounds() as f64,
        )
    }

    /// Whether the training has ended.
    pub fn has_ended(&self) -> bool {
        self.state.orders.len() >= self.task.settings.rounds()
    }

    /// For each round, the flock-hours at its end and its mean order.
    pub fn curve(&self) -> impl Iterator<Item = (f64, f64)> {
        let round_hours = self.task.settings.round_hours();
        (1..)
            .zip(&self.state.orders)
            .map(move |(round, &order)| (round_hours * f64::from(round), order))
    }

    /// Three numbers about the branches of whole rounds: how many there were, in how many a flock left an overlap deeper
    /// than the tolerance, and the deepest overlap in cm.
    pub fn overlaps(&self) -> (u64, u64, f64) {
        let branches = self.state.orders.len() * self.task.settings.pairs;
        let TrainingState {
            unsolved,
            worst_overlap_cm,
            ..
        } = self.state;
        (branches as u64, unsolved, worst_overlap_cm)
    }

    /// Runs up to `branches` more branches of the current round, at least one. Each is the branch of one pair of flocks.
    /// Changes the weights if these branches complete the round.
    ///
    /// # Errors
    /// [`FlockError::Interrupted`] if `keep_going` returned false, and errors of the flocks; nothing has changed then.
    pub fn advance(&mut self, keep_going: KeepGoing, branches: usize) -> Result<()> {
        if self.has_ended() {
            return Ok(());
        }
        let Self { task, state, .. } = &*self;
        let (round, first) = (state.orders.len(), self.finished.len());
        let end = state.pairs.len().min(first.saturating_add(branches.max(1)));
        let law = self.law_from_weights(&state.weights[round])?;
        let run =
            |number: usize| task.branch(keep_going, &law, (round, number), &state.pairs[number]);
        let outcomes = parallel::map((first..end).collect(), run);
        let outcomes: Result<Vec<_>> = outcomes.into_iter().collect();
        self.finished.extend(outcomes?);
        if self.finished.len() == self.state.pairs.len() {
            self.end_round();
        }
        Ok(())
    }

    /// Adds the finished branches to the sums of the regression, and takes a step of the weights.
    fn end_round(&mut self) {
        let (settings, state) = (&self.task.settings, &mut self.state);
        let sums = state.regressor_squares.iter_mut();
        let sums = sums.chain(&mut state.slope_squares);
        for sum in sums.chain([&mut state.regressor_products]).flatten() {
            *sum *= settings.memory;
        }
        state.rounds = settings.memory * state.rounds + 1.0;
        let mut mean_order = 0.0;
        for ((outcome, next_pair), pair) in self.finished.drain(..).zip(&mut state.pairs) {
            let regressors = &outcome.regressors;
            add_square(&mut state.regressor_squares, 1.0, regressors);
            for (sum, regressor) in state.regressor_products.iter_mut().zip(regressors) {
                *sum += regressor * outcome.order_difference;
            }
            let share = 1.0 / (settings.pairs * outcome.action_slopes.len()) as f64;
            for slopes in &outcome.action_slopes {
                add_square(&mut state.slope_squares, share, slopes);
            }
            mean_order += outcome.order / settings.pairs as f64;
            state.unsolved += u64::from(outcome.is_unsolved);
            state.worst_overlap_cm = state.worst_overlap_cm.max(outcome.worst_overlap_cm);
            *pair = next_pair;
        }
        let weights = state.stepped_weights(settings);
        state.weights.push(weights);
        state.orders.push(mean_order);
    }

    /// The law with the mean weights over the second half of the rounds until now.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for weights that are not finite.
    pub fn law(&self) -> Result<LeaningLaw> {
        let second_half = &self.state.weights[self.state.orders.len().div_ceil(2)..];
        let mean: Features = std::array::from_fn(|k| {
            let sum = second_half
                .iter()
                .fold(0.0, |sum, weights| sum + weights[k]);
            sum / second_half.len() as f64
        });
        self.law_from_weights(&mean)
    }

    /// The law with these weights, which are in units of the largest action.
    fn law_from_weights(&self, weights: &Features) -> Result<LeaningLaw> {
        let Task {
            settings,
            parameters,
            ..
        } = &self.task;
        let pool = parameters.pool.name();
        let (gains, decision_period_s, largest_action) = match settings.action_mode {
            ActionMode::Rudder => (None, Some(settings.decision_period_s), 1.0),
            ActionMode::Lean | ActionMode::Heading => {
                let gains = DampedLaw::tuned("action_mode", "\"lean\"", pool)?;
                // With leans, the law decides at every control step: it leads better than if it holds leans as in the
                // training.
                (Some(gains), None, LARGEST_LEAN)
            }
        };
        let numbers = weights.map(|weight| largest_action * weight);
        LeaningLaw::new(pool, gains, decision_period_s, &numbers)
    }

    /// The training after its last whole round as bytes. The branches of an unfinished round are not stored, so that a
    /// restored training runs them again.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Task {
            settings,
            parameters,
            seed,
            first_seed,
            ..
        } = &self.task;
        let state = &self.state;
        seal(&MAGIC, &(settings, parameters, seed, first_seed, state))
    }

    /// Restores a training from its bytes; it continues bit for bit.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged training with finite weights.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let (settings, parameters, seed, first_seed, state) = unseal(&MAGIC, bytes)?;
        let state: TrainingState = state;
        let mut trainer = Self::new(settings, parameters, seed, first_seed)?;
        let Task { settings, .. } = &trainer.task;
        let reason = "the training has weights that are not finite, or parts are missing";
        FlockError::unless_fitting(state.fits(settings.pairs, settings.branches()), reason)?;
        trainer.state = state;
        trainer.law()?;
        trainer.task.check(&trainer.state.pairs)?;
        Ok(trainer)
    }

    /// This training, which now ends after `flock_hours`.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn until(mut self, flock_hours: f64) -> Result<Self> {
        self.task.settings.flock_hours = flock_hours;
        self.task.settings.check(&self.task.parameters)?;
        Ok(self)
    }
}
