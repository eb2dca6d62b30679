//! One branch of a pair of flocks: both start from the same state with the same noise, and their leaders add opposite
//! offsets to the law's actions.

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

/// The state of a pair of flocks between two branches.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Pair {
    /// State from which both flocks continue; `None`: at rest, placed at random.
    pub snapshot: Option<Vec<u8>>,
    /// Whether the target is clockwise.
    pub is_clockwise: bool,
    /// Number of branches until the end of the episode.
    pub branches_left: usize,
    /// Number of the episode, from 0.
    pub episode: u64,
}

/// Outcome of a branch for the regression.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// The regressors: offset times action slopes, summed over all offsets and both flocks.
    pub regressors: Features,
    /// The regressed number: order of the flock with the offsets minus that of the flock with the opposite offsets,
    /// summed over the decisions after `blind_s`.
    pub order_difference: f64,
    /// For each offset, the mean of both flocks' action slopes.
    pub action_slopes: Vec<Features>,
    /// Mean order of both flocks.
    pub order: f64,
    /// Whether a substep of either flock left an overlap deeper than the tolerance.
    pub is_unsolved: bool,
    /// Deepest overlap of either flock since its start, in cm.
    pub worst_overlap_cm: f64,
}

/// One of the two flocks after its branch.
struct LedFlock {
    /// For each offset, the derivatives of its leader's action with respect to the weights, averaged over the first
    /// `seen_s` of its hold.
    action_slopes: Vec<Features>,
    /// Sum of the order over all decisions.
    order_sum: f64,
    /// Sum of the order over the decisions after `blind_s`.
    judged_order_sum: f64,
    /// Whether a substep of this branch left an overlap deeper than the tolerance.
    is_unsolved: bool,
    flock: Flock,
}

/// True or false, each with a chance of one half.
fn coin(random: &mut StreamRng) -> bool {
    random.next_u32() & 1 == 1
}

impl Task {
    /// The pair with this number before its first branch. First episodes differ in length, so that not all pairs start
    /// their second episode in the same round.
    pub(super) fn pair(&self, number: usize) -> Pair {
        let branches_per_episode = self.settings.branches();
        // Of pairs 2k and 2k + 1, whose episodes are equally long, the first has a clockwise target.
        Pair {
            snapshot: None,
            is_clockwise: number.is_multiple_of(2),
            branches_left: 1 + number / 2 % branches_per_episode,
            episode: 0,
        }
    }

    /// Runs the branch of the pair `number` in the round `round`; returns the outcome and the pair's next state. Both
    /// depend only on the task and the arguments.
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
        let holds = self.decisions.trial / self.decisions.hold;
        let offsets: Vec<f64> = (0..holds * self.parameters.n_leaders)
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
            let signed_offsets: Vec<f64> = offsets.iter().map(|offset| sign * offset).collect();
            self.lead(keep_going, law, &request, &signed_offsets)
        });
        let (plus, minus) = (plus?, minus?);
        let outcome = self.outcome(&offsets, &plus, &minus);
        let continued = if coin(&mut random) { plus } else { minus };
        let is_clockwise = coin(&mut random);
        let next_pair = self.next_pair(pair, &continued, is_clockwise);
        Ok((outcome, next_pair))
    }

    /// Checks that pairs can start their next branches.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for flocks of another task.
    pub(super) fn check(&self, pairs: &[Pair]) -> Result<()> {
        let env = FlockEnv::new(&self.env_settings, self.parameters.clone());
        let keep_going = || true;
        for (number, pair) in pairs.iter().enumerate() {
            if pair.snapshot.is_some() {
                env.prepare(&self.env_settings, &self.request(number, pair), &keep_going)?;
            }
        }
        Ok(())
    }

    /// The reset that starts a pair's next branch. Each episode of each pair has its own flock seed.
    fn request(&self, number: usize, pair: &Pair) -> ResetRequest {
        let target = if pair.is_clockwise {
            Target::Clockwise
        } else {
            Target::CounterClockwise
        };
        let flock_number = number as u64 + self.settings.pairs as u64 * pair.episode;
        let start = pair.snapshot.clone().map(|bytes| Start::Snapshot {
            bytes,
            noise_seed: None,
        });
        ResetRequest {
            seed: Some(self.first_seed.wrapping_add(flock_number)),
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
    ) -> Result<LedFlock> {
        let (leaders, settings) = (self.parameters.n_leaders, &self.env_settings);
        let mut env = FlockEnv::new(settings, self.parameters.clone());
        let mut observations = vec![0.0; leaders * LEAN_FEATURES];
        let prepared = env.prepare(settings, request, keep_going)?;
        env.start(prepared, &mut observations);
        let unsolved_before = flock(&env)?.statistics().unsolved;
        let (mut actions, mut rewards) = (vec![0.0; leaders], vec![0.0; leaders]);
        let mut action_slopes = vec![[0.0; SIZE]; offsets.len()];
        let (mut order_sum, mut judged_order_sum) = (0.0, 0.0);
        for decision in 0..self.decisions.branch {
            if !keep_going() {
                return Err(FlockError::Interrupted);
            }
            self.add_slopes(law, decision, &observations, &mut action_slopes);
            self.decide(law, decision, &observations, offsets, &mut actions);
            let (actions, observations) = (Some(&actions[..]), &mut observations);
            env.step(keep_going, settings, actions, observations, &mut rewards)?;
            // All leaders have the same reward.
            order_sum += rewards[0];
            if decision >= self.decisions.blind {
                judged_order_sum += rewards[0];
            }
        }
        let flock = flock(&env)?.clone();
        Ok(LedFlock {
            action_slopes,
            order_sum,
            judged_order_sum,
            is_unsolved: flock.statistics().unsolved > unsolved_before,
            flock,
        })
    }

    /// Writes the leaders' actions for a decision: the law's action, plus the leader's offset in the present hold. After
    /// `trial_s` there are no offsets.
    fn decide(
        &self,
        law: &LeaningLaw,
        decision: usize,
        observations: &[f32],
        offsets: &[f64],
        actions: &mut [f64],
    ) {
        let first_offset = decision / self.decisions.hold * self.parameters.n_leaders;
        for (leader, row) in observations.chunks_exact(LEAN_FEATURES).enumerate() {
            let offset = offsets.get(first_offset + leader).copied();
            actions[leader] = f64::from(law.action(row)) + offset.unwrap_or(0.0);
        }
    }

    /// Adds the slopes of the leaders' actions in this decision to the means of `action_slopes`, which cover the first
    /// `seen_s` of each hold.
    fn add_slopes(
        &self,
        law: &LeaningLaw,
        decision: usize,
        observations: &[f32],
        action_slopes: &mut [Features],
    ) {
        let Decisions {
            hold: decisions_per_hold,
            seen: averaged_decisions,
            ..
        } = self.decisions;
        let decision_in_hold = decision % decisions_per_hold;
        if decision_in_hold >= averaged_decisions {
            return;
        }
        let first_offset = decision / decisions_per_hold * self.parameters.n_leaders;
        for (leader, row) in observations.chunks_exact(LEAN_FEATURES).enumerate() {
            if let Some(mean) = action_slopes.get_mut(first_offset + leader) {
                // The action is the tanh of Σ weight·feature, and 1 − tanh² is the derivative of tanh.
                let action = f64::from(law.action(row));
                add_observation(
                    mean,
                    row,
                    (1.0 - action * action) / averaged_decisions as f64,
                );
            }
        }
    }

    /// The outcome of a branch from the flock with the offsets and the flock with the opposite offsets.
    fn outcome(&self, offsets: &[f64], plus: &LedFlock, minus: &LedFlock) -> Outcome {
        let action_slopes: Vec<Features> = plus
            .action_slopes
            .iter()
            .zip(&minus.action_slopes)
            .map(|(plus, minus)| std::array::from_fn(|k| 0.5 * (plus[k] + minus[k])))
            .collect();
        let mut regressors = [0.0; SIZE];
        for (offset, slopes) in offsets.iter().zip(&action_slopes) {
            for (sum, slope) in regressors.iter_mut().zip(slopes) {
                *sum += 2.0 * offset * slope;
            }
        }
        let worst_overlap_cm = |led: &LedFlock| led.flock.statistics().worst_overlap_cm;
        Outcome {
            regressors,
            order_difference: plus.judged_order_sum - minus.judged_order_sum,
            action_slopes,
            order: 0.5 * (plus.order_sum + minus.order_sum) / self.decisions.branch as f64,
            is_unsolved: plus.is_unsolved || minus.is_unsolved,
            worst_overlap_cm: worst_overlap_cm(plus).max(worst_overlap_cm(minus)),
        }
    }

    /// The pair after a branch: it continues from the state of one of its flocks, or starts a new episode with the
    /// target that `is_clockwise` selects.
    fn next_pair(&self, pair: &Pair, continued: &LedFlock, is_clockwise: bool) -> Pair {
        if pair.branches_left <= 1 {
            return Pair {
                snapshot: None,
                is_clockwise,
                branches_left: self.settings.branches(),
                episode: pair.episode + 1,
            };
        }
        Pair {
            snapshot: Some(continued.flock.snapshot()),
            branches_left: pair.branches_left - 1,
            ..pair.clone()
        }
    }
}

/// The flock of an environment that has been reset.
fn flock(env: &FlockEnv) -> Result<&Flock> {
    let missing = || FlockError::Episode("the branch has no flock".to_owned());
    env.episode().map(Episode::flock).ok_or_else(missing)
}

/// Adds an observation, and 1 for the bias, times a factor to `sums`.
fn add_observation(sums: &mut Features, observation: &[f32], factor: f64) {
    let [feature_sums @ .., bias_sum] = sums;
    for (sum, &value) in feature_sums.iter_mut().zip(observation) {
        *sum += factor * f64::from(value);
    }
    *bias_sum += factor;
}
