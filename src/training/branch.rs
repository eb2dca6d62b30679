//! One branch of a pair: two flocks from one state with one noise, whose leaders try opposite offsets.

use super::BranchSettings;
use super::regression::{Features, SIZE};
use super::settings::Decisions;
use crate::contact::KeepGoing;
use crate::environment::observation::LEAN_FEATURES;
use crate::environment::{EnvSettings, Episode, FlockEnv, ResetRequest, Start, TargetChoice};
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::parameters::{FlockParameters, Target};
use crate::policies::LeaningLaw;
use crate::random::{Stream, StreamRng};
use rand_chacha::rand_core::Rng;

/// The task of a training, which all its branches share.
#[derive(Debug, Clone)]
pub(super) struct Task {
    pub settings: BranchSettings,
    pub parameters: FlockParameters,
    pub env_settings: EnvSettings,
    pub decisions: Decisions,
    pub seed: u64,
    pub first_seed: u64,
}

/// A pair of flocks between two branches.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Pair {
    /// State from which both continue; `None`: at rest, placed at random.
    pub snapshot: Option<Vec<u8>>,
    pub is_clockwise: bool,
    /// Branches until the end of the episode.
    pub left: usize,
    /// Number of the episode.
    pub episode: u64,
}

/// Outcome of a branch for the regression.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// Sum over both flocks and all offsets: offset times features of its decisions.
    pub tried: Features,
    /// Order of the flock with the offsets minus that of the flock with the opposite offsets, summed over decisions.
    pub difference: f64,
    /// Features of each offset's decisions, mean of both flocks.
    pub features: Vec<Features>,
    /// Mean order of both.
    pub order: f64,
    /// Whether a substep of either flock left an overlap deeper than the tolerance.
    pub is_unsolved: bool,
    /// Deepest overlap of either flock since its start, in cm.
    pub worst_overlap_cm: f64,
}

/// One of the two flocks after its branch.
struct Side {
    features: Vec<Features>,
    order: f64,
    judged: f64,
    is_unsolved: bool,
    flock: Flock,
}

fn coin(random: &mut StreamRng) -> bool {
    random.next_u32() & 1 == 1
}

impl Task {
    /// The pair with this number before its first branch. Pairs end their first episodes at different times.
    pub(super) fn pair(&self, number: usize) -> Pair {
        let branches = self.settings.branches();
        Pair {
            snapshot: None,
            is_clockwise: number.is_multiple_of(2),
            left: 1 + number / 2 % branches,
            episode: 0,
        }
    }

    /// Runs a branch of a pair in a round; returns its outcome and the pair after it. Both depend on nothing but the
    /// arguments.
    ///
    /// # Errors
    /// [`FlockError::Placement`], [`FlockError::Solver`], [`FlockError::Snapshot`] and [`FlockError::Interrupted`].
    pub(super) fn branch(
        &self,
        keep_going: KeepGoing,
        law: &LeaningLaw,
        (round, number): (usize, usize),
        pair: &Pair,
    ) -> Result<(Outcome, Pair)> {
        let mut random = Stream::TRAINING.rng(self.seed);
        random.set_stream((round * self.settings.pairs + number) as u64);
        let tries = self.decisions.trial / self.decisions.hold * self.parameters.n_leaders;
        let offsets: Vec<f64> = (0..tries)
            .map(|_| {
                if coin(&mut random) {
                    self.settings.offset
                } else {
                    -self.settings.offset
                }
            })
            .collect();
        let request = self.request(number, pair);
        let [plus, minus] = [1.0, -1.0].map(|sign| {
            let tried: Vec<f64> = offsets.iter().map(|x| sign * x).collect();
            self.lead(keep_going, law, &request, &tried)
        });
        let (plus, minus) = (plus?, minus?);
        let outcome = self.outcome(&offsets, &plus, &minus);
        let continued = if coin(&mut random) { plus } else { minus };
        let next = self.next(pair, &continued, coin(&mut random))?;
        Ok((outcome, next))
    }

    /// Checks that pairs can start their next branches.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for flocks of another task.
    pub(super) fn check(&self, pairs: &[Pair]) -> Result<()> {
        let env = FlockEnv::new(&self.env_settings, self.parameters.clone());
        for (number, pair) in pairs
            .iter()
            .enumerate()
            .filter(|(_, pair)| pair.snapshot.is_some())
        {
            env.prepare(&self.env_settings, &self.request(number, pair), &|| true)?;
        }
        Ok(())
    }

    fn request(&self, number: usize, pair: &Pair) -> ResetRequest {
        let target = if pair.is_clockwise {
            Target::Clockwise
        } else {
            Target::CounterClockwise
        };
        let flock = number as u64 + self.settings.pairs as u64 * pair.episode;
        let start = pair.snapshot.clone().map(|bytes| Start::Snapshot {
            bytes,
            noise_seed: None,
        });
        ResetRequest {
            seed: Some(self.first_seed.wrapping_add(flock)),
            target: Some(TargetChoice::Fixed(target.into())),
            bw_s: None,
            start: start.unwrap_or_default(),
        }
    }

    /// Leads one flock through a branch; `offsets` holds all leaders' offsets, one hold after another.
    fn lead(
        &self,
        keep_going: KeepGoing,
        law: &LeaningLaw,
        request: &ResetRequest,
        offsets: &[f64],
    ) -> Result<Side> {
        let (leaders, settings) = (self.parameters.n_leaders, &self.env_settings);
        let mut env = FlockEnv::new(settings, self.parameters.clone());
        let mut seen = vec![0.0; leaders * LEAN_FEATURES];
        env.start(env.prepare(settings, request, keep_going)?, &mut seen);
        let unsolved = flock_of(&env)?.statistics().unsolved;
        let (mut actions, mut rewards) = (vec![0.0; leaders], vec![0.0; leaders]);
        let (mut features, mut order, mut judged) = (vec![[0.0; SIZE]; offsets.len()], 0.0, 0.0);
        for decision in 0..self.decisions.branch {
            if !keep_going() {
                return Err(FlockError::Interrupted);
            }
            self.decide(law, decision, &seen, offsets, &mut features, &mut actions);
            env.step(
                keep_going,
                settings,
                Some(&actions),
                &mut seen,
                &mut rewards,
            )?;
            order += rewards[0];
            if decision >= self.decisions.blind {
                judged += rewards[0];
            }
        }
        let flock = flock_of(&env)?.clone();
        Ok(Side {
            features,
            order,
            judged,
            is_unsolved: flock.statistics().unsolved > unsolved,
            flock,
        })
    }

    /// Writes the actions of a decision, the law's plus the offsets, and adds the leaders' observations to the features
    /// of these offsets.
    fn decide(
        &self,
        law: &LeaningLaw,
        decision: usize,
        seen: &[f32],
        offsets: &[f64],
        features: &mut [Features],
        actions: &mut [f64],
    ) {
        let Decisions {
            hold,
            seen: seen_for,
            ..
        } = self.decisions;
        let first = decision / hold * actions.len();
        for (leader, row) in seen.chunks_exact(LEAN_FEATURES).enumerate() {
            let action = f64::from(law.action(row));
            let offset = offsets.get(first + leader);
            let is_seen = decision % hold < seen_for;
            if let Some(felt) = features.get_mut(first + leader).filter(|_| is_seen) {
                add(felt, row, (1.0 - action * action) / seen_for as f64);
            }
            actions[leader] = action + offset.copied().unwrap_or(0.0);
        }
    }

    fn outcome(&self, offsets: &[f64], plus: &Side, minus: &Side) -> Outcome {
        let both = plus.features.iter().zip(&minus.features);
        let features: Vec<Features> = both
            .map(|(a, b)| std::array::from_fn(|k| 0.5 * (a[k] + b[k])))
            .collect();
        let worst = |side: &Side| side.flock.statistics().worst_overlap_cm;
        let mut tried = [0.0; SIZE];
        for (offset, felt) in offsets.iter().zip(&features) {
            for (sum, value) in tried.iter_mut().zip(felt) {
                *sum += 2.0 * offset * value;
            }
        }
        Outcome {
            tried,
            difference: plus.judged - minus.judged,
            features,
            order: 0.5 * (plus.order + minus.order) / self.decisions.branch as f64,
            is_unsolved: plus.is_unsolved || minus.is_unsolved,
            worst_overlap_cm: worst(plus).max(worst(minus)),
        }
    }

    /// The pair after a branch: it continues from the state of one of its flocks, or starts a new episode.
    fn next(&self, pair: &Pair, continued: &Side, is_clockwise: bool) -> Result<Pair> {
        if pair.left <= 1 {
            return Ok(Pair {
                snapshot: None,
                is_clockwise,
                left: self.settings.branches(),
                episode: pair.episode + 1,
            });
        }
        Ok(Pair {
            snapshot: Some(continued.flock.snapshot()),
            left: pair.left - 1,
            ..pair.clone()
        })
    }
}

fn flock_of(env: &FlockEnv) -> Result<&Flock> {
    let none = || FlockError::Episode("the branch has no flock".to_owned());
    env.episode().map(Episode::flock).ok_or_else(none)
}

/// Adds an observation, and 1 for the bias, times a factor to `sum`.
fn add(sum: &mut Features, row: &[f32], factor: f64) {
    let [features @ .., bias] = sum;
    for (sum, &value) in features.iter_mut().zip(row) {
        *sum += factor * f64::from(value);
    }
    *bias += factor;
}
