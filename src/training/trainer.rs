//! A training, round after round.

use super::BranchSettings;
use super::branch::{Outcome, Pair, Task};
use super::regression::{Features, Matrix, SIZE, add_square, dot, product, ridge};
use crate::boat::DampedLaw;
use crate::contact::KeepGoing;
use crate::environment::{ActionMode, LARGEST_LEAN};
use crate::error::{FlockError, Result};
use crate::parallel;
use crate::parameters::FlockParameters;
use crate::policies::LeaningLaw;
use crate::sealed_bytes::{Magic, seal, unseal};

const MAGIC: Magic = *b"flocktr2";

/// State of a training between two rounds.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Memory {
    /// Weights before the first round and after each.
    weights: Vec<Features>,
    /// Mean order of each round.
    orders: Vec<f64>,
    /// Sums of squares of the tried offsets times features, and of their products with the differences; earlier rounds
    /// count less.
    tried: Matrix,
    differences: Features,
    /// Sum of the features' squares, and the number of rounds in it, where earlier rounds count less.
    features: Matrix,
    rounds: f64,
    /// Branches in which a flock left an overlap deeper than the tolerance, and the deepest of all, in cm.
    unsolved: u64,
    worst_overlap_cm: f64,
    pairs: Vec<Pair>,
}

impl Memory {
    /// Whether this state fits a training of so many pairs, with so many branches in an episode.
    fn fits(&self, pairs: usize, branches: usize) -> bool {
        let sums = self
            .tried
            .iter()
            .chain(&self.features)
            .chain([&self.differences]);
        let numbers = sums.chain(&self.weights).flatten().chain(&self.orders);
        let mut all = numbers.chain([&self.rounds, &self.worst_overlap_cm]);
        all.all(|number| number.is_finite())
            && self.weights.len() == self.orders.len() + 1
            && self.pairs.len() == pairs
            && self
                .pairs
                .iter()
                .all(|pair| (1..=branches).contains(&pair.left))
    }
}

/// Trains leaders whose leans or rudders are linear in the lean features.
///
/// In a round each pair of flocks goes through a branch: from one state, with one noise, and with opposite offsets of
/// the leaders' actions. The difference of their orders is regressed on the offsets times the features. The result says
/// how much each weight raises the order, and the weights take a step in that direction.
#[derive(Debug, Clone)]
pub struct Trainer {
    task: Task,
    memory: Memory,
    /// Finished branches of the current round.
    under_way: Vec<(Outcome, Pair)>,
}

impl Trainer {
    /// A training at its start. The seed decides the offsets; its flocks have consecutive seeds from the first one on.
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
        let memory = Memory {
            weights: vec![[0.0; SIZE]],
            orders: Vec::new(),
            tried: [[0.0; SIZE]; SIZE],
            differences: [0.0; SIZE],
            features: [[0.0; SIZE]; SIZE],
            rounds: 0.0,
            unsolved: 0,
            worst_overlap_cm: 0.0,
            pairs: pairs.collect(),
        };
        let under_way = Vec::new();
        let trainer = Self {
            task,
            memory,
            under_way,
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

    /// Simulated time of all flocks together until now and at the end, in hours.
    pub fn flock_hours(&self) -> (f64, f64) {
        let settings = &self.task.settings;
        let part = self.under_way.len() as f64 / settings.pairs as f64;
        let hours = settings.round_hours();
        (
            hours * (self.memory.orders.len() as f64 + part),
            hours * settings.rounds() as f64,
        )
    }

    /// Whether the training has ended.
    pub fn has_ended(&self) -> bool {
        self.memory.orders.len() >= self.task.settings.rounds()
    }

    /// Flock-hours and mean order of each round.
    pub fn curve(&self) -> impl Iterator<Item = (f64, f64)> {
        let hours = self.task.settings.round_hours();
        (1..)
            .zip(&self.memory.orders)
            .map(move |(round, &order)| (hours * f64::from(round), order))
    }

    /// Number of branches in whole rounds, of those in which a flock left an overlap deeper than the tolerance, and the
    /// deepest overlap in cm.
    pub fn overlaps(&self) -> (u64, u64, f64) {
        let branches = self.memory.orders.len() * self.task.settings.pairs;
        let Memory {
            unsolved,
            worst_overlap_cm,
            ..
        } = self.memory;
        (branches as u64, unsolved, worst_overlap_cm)
    }

    /// Runs up to this many more branches, each of one pair of flocks, and changes the weights when a round is over.
    ///
    /// # Errors
    /// [`FlockError::Interrupted`] if `keep_going` returned false, and errors of the flocks; nothing has changed then.
    pub fn advance(&mut self, keep_going: KeepGoing, branches: usize) -> Result<()> {
        if self.has_ended() {
            return Ok(());
        }
        let (round, first) = (self.memory.orders.len(), self.under_way.len());
        let last = self
            .memory
            .pairs
            .len()
            .min(first.saturating_add(branches.max(1)));
        let law = self.law_of(&self.memory.weights[round])?;
        let work = |number: usize| {
            self.task.branch(
                keep_going,
                &law,
                (round, number),
                &self.memory.pairs[number],
            )
        };
        let outcomes: Result<Vec<_>> = parallel::map((first..last).collect(), work)
            .into_iter()
            .collect();
        self.under_way.extend(outcomes?);
        if self.under_way.len() == self.memory.pairs.len() {
            self.take_step();
        }
        Ok(())
    }

    /// Ends a round: the weights take a step along the natural gradient.
    fn take_step(&mut self) {
        let (settings, memory) = (&self.task.settings, &mut self.memory);
        let sums = memory.tried.iter_mut().chain(&mut memory.features);
        for sum in sums.chain([&mut memory.differences]).flatten() {
            *sum *= settings.memory;
        }
        memory.rounds = settings.memory * memory.rounds + 1.0;
        let mut order = 0.0;
        for ((outcome, next), pair) in self.under_way.drain(..).zip(&mut memory.pairs) {
            add_square(&mut memory.tried, 1.0, &outcome.tried);
            for (sum, tried) in memory.differences.iter_mut().zip(&outcome.tried) {
                *sum += tried * outcome.difference;
            }
            let share = 1.0 / (settings.pairs * outcome.features.len()) as f64;
            for features in &outcome.features {
                add_square(&mut memory.features, share, features);
            }
            order += outcome.order / settings.pairs as f64;
            memory.unsolved += u64::from(outcome.is_unsolved);
            memory.worst_overlap_cm = memory.worst_overlap_cm.max(outcome.worst_overlap_cm);
            *pair = next;
        }
        let gradient = ridge(&memory.tried, settings.ridge, &memory.differences);
        let square = dot(&gradient, &product(&memory.features, &gradient)) / memory.rounds;
        let left = 1.0 - memory.orders.len() as f64 / settings.rounds() as f64;
        let rate = settings.step * left.max(0.0) / (square.max(0.0).sqrt() + 1e-12);
        let weights = &memory.weights[memory.orders.len()];
        let next = std::array::from_fn(|k| weights[k] + rate * gradient[k]);
        memory.weights.push(next);
        memory.orders.push(order);
    }

    /// The law of the mean weights over the second half of the rounds until now.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for weights that are not finite.
    pub fn law(&self) -> Result<LeaningLaw> {
        let half = &self.memory.weights[self.memory.orders.len().div_ceil(2)..];
        let mean: Features = std::array::from_fn(|k| {
            half.iter().fold(0.0, |sum, weights| sum + weights[k]) / half.len() as f64
        });
        self.law_of(&mean)
    }

    fn law_of(&self, weights: &Features) -> Result<LeaningLaw> {
        let Task {
            settings,
            parameters,
            ..
        } = &self.task;
        let pool = parameters.pool.name();
        let numbers = |largest| weights.map(|weight| largest * weight);
        if settings.action_mode == ActionMode::Rudder {
            let period = Some(settings.decision_period_s);
            return LeaningLaw::new(pool, None, period, &numbers(1.0));
        }
        // The law decides at every control step, since it then leads better than with leans that are held as in the
        // training.
        let gains = DampedLaw::tuned("action_mode", "\"lean\"", pool)?;
        LeaningLaw::new(pool, Some(gains), None, &numbers(LARGEST_LEAN))
    }

    /// The training after its last whole round as bytes; branches of an unfinished round are taken again.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Task {
            settings,
            parameters,
            seed,
            first_seed,
            ..
        } = &self.task;
        seal(
            &MAGIC,
            &(settings, parameters, seed, first_seed, &self.memory),
        )
    }

    /// A training from its bytes, which continues bit for bit.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged training with finite weights.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let (settings, parameters, seed, first_seed, memory) = unseal(&MAGIC, bytes)?;
        let mut trainer = Self::new(settings, parameters, seed, first_seed)?;
        let Task { settings, .. } = &trainer.task;
        let why = "the training has weights that are not finite, or parts are missing";
        let memory: Memory = memory;
        FlockError::unless_fitting(memory.fits(settings.pairs, settings.branches()), why)?;
        trainer.memory = memory;
        trainer.law()?;
        trainer.task.check(&trainer.memory.pairs)?;
        Ok(trainer)
    }

    /// This training, to end at other `flock_hours`.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn until(mut self, flock_hours: f64) -> Result<Self> {
        self.task.settings.flock_hours = flock_hours;
        self.task.settings.check(&self.task.parameters)?;
        Ok(self)
    }
}
