//! How leaders steer on the page: one policy for all, the visitor, or a policy for each.

use flockenv::boat::DampedLaw;
use flockenv::environment::observation::{Block, LEAN_FEATURES, ObservationLayout, observe_flock};
use flockenv::parameters::FlockParameters;
use flockenv::policies::{Law, LeaningLaw, ObservedLaw, Pilot};
use flockenv::{Flock, FlockError, Result};
use std::f64::consts::{FRAC_PI_2, PI};

/// The name of the paper's law at every substep, as on the command line.
pub(crate) const EVERY_SUBSTEP: &str = Law::EVERY_SUBSTEP;

/// Decisions per second of all policies but the law at every substep.
pub(crate) const CONTROL_HZ: f64 = 10.0;

/// The name, in requests, of the policy that the visitor trained.
pub(crate) const TRAINED: &str = "trained";

/// The weights of an untrained policy, whose rudders are 0.
const UNTRAINED: [f64; LEAN_FEATURES + 1] = [0.0; LEAN_FEATURES + 1];

/// How the leaders of a flock steer.
pub(crate) enum Leaders {
    /// By the paper's law at every substep.
    EverySubstep,
    /// By a law, at every decision.
    Law(Pilot),
    /// To the visitor's heading, by the damped law.
    You(Pilot),
    /// Each leader by a law of its own, from its observation.
    Each(Vec<ObservingLeader>),
}

/// A leader with a law of its own, and the observation that the law takes.
pub(crate) struct ObservingLeader {
    law: ObservedLaw,
    layout: ObservationLayout,
}

impl Leaders {
    /// The policy of this name, or a policy for each leader from names that are separated by commas. `trained`: the policy
    /// that the visitor trained, in JSON; without it, trained leaders head straight ahead.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for unknown names, and for flocks that the policy cannot lead.
    pub fn named(name: &str, trained: Option<&str>, parameters: &FlockParameters) -> Result<Self> {
        if name.contains(',') {
            return Self::one_law_each(&name.split(',').collect::<Vec<_>>(), parameters);
        }
        match name {
            EVERY_SUBSTEP => Ok(Self::EverySubstep),
            "you" if parameters.n_leaders == 0 => {
                Err(refused(name, "at least one leader, whom you steer"))
            }
            "you" => {
                let damped = Law::Damped(DampedLaw::default());
                Pilot::new(damped, parameters, CONTROL_HZ).map(Self::You)
            }
            TRAINED => {
                let law = match trained {
                    Some(json) => LeaningLaw::from_json(json)?,
                    None => LeaningLaw::new(parameters.pool.name(), None, None, &UNTRAINED)?,
                };
                let law = Law::Leaning(Box::new(law));
                Pilot::new(law, parameters, CONTROL_HZ).map(Self::Law)
            }
            _ => Pilot::new(law(name, parameters)?, parameters, CONTROL_HZ).map(Self::Law),
        }
    }

    /// Leaders of which each has a law of its own, by the names of the laws.
    fn one_law_each(names: &[&str], parameters: &FlockParameters) -> Result<Self> {
        if names.len() != parameters.n_leaders {
            let accepted = format!("one policy for each of {} leaders", parameters.n_leaders);
            return Err(refused(&names.join(","), &accepted));
        }
        let leaders = names.iter().map(|name| {
            let law = law(name, parameters)?;
            let mut layout = ObservationLayout::default();
            // As in Python, a leaning law takes lean features, mirrored to a clockwise target.
            let is_leaning = matches!(law, Law::Leaning(_));
            layout.repeat(Block::LeanFeatures, usize::from(is_leaning));
            layout = layout.mirrored(is_leaning);
            let law = ObservedLaw::new(law, &layout)?;
            Ok(ObservingLeader { law, layout })
        });
        leaders.collect::<Result<_>>().map(Self::Each)
    }

    /// The next rudders, from the present rudders; `None` for the law at every substep. `heading`: the heading
    /// that the visitor sets for all leaders, clockwise from outward, divided by π.
    ///
    /// # Errors
    /// As for [`Pilot::rudders`] and [`observe_flock`].
    pub fn decide(
        &mut self,
        flock: &Flock,
        present_rudders: &[f64],
        heading: f64,
    ) -> Result<Option<Vec<f64>>> {
        match self {
            Self::EverySubstep => Ok(None),
            Self::Law(pilot) => pilot.rudders(flock).map(Some),
            Self::You(pilot) => {
                let targets = &flock.parameters().target;
                let leaders = 0..flock.parameters().n_leaders;
                // A lean is measured from the target's tangent, a quarter turn from outward.
                pilot.lean_to(leaders.map(|k| FRAC_PI_2 - targets.of(k).sign() * PI * heading));
                pilot.rudders(flock).map(Some)
            }
            Self::Each(leaders) => {
                let leaders = leaders.iter().enumerate();
                leaders
                    .map(|(index, leader)| leader.next_rudder(flock, present_rudders, index))
                    .collect::<Result<_>>()
                    .map(Some)
            }
        }
    }
}

impl ObservingLeader {
    /// The next rudder of the leader with this index.
    fn next_rudder(&self, flock: &Flock, present_rudders: &[f64], leader: usize) -> Result<f64> {
        let observations = observe_flock(flock, self.layout, present_rudders)?;
        let size = self.layout.size();
        let action = self.law.action(&observations[leader * size..][..size]);
        let sign = flock.parameters().target.of(leader).sign();
        // A mirrored observation gives a rudder for a clockwise target.
        Ok(if self.layout.is_mirrored {
            sign * action
        } else {
            action
        })
    }
}

/// The error for a choice of leaders that is not accepted.
fn refused(name: &str, accepted: &str) -> FlockError {
    FlockError::parameter("leaders", name, accepted)
}

/// The law with this name, which acts at every decision.
fn law(name: &str, parameters: &FlockParameters) -> Result<Law> {
    let mut names: Vec<_> = Law::NAMED.iter().map(|law| law.name).collect();
    names.retain(|name| *name != EVERY_SUBSTEP);
    if !names.contains(&name) {
        let names = names.join(", ");
        let accepted = format!("{names}, or for all leaders {EVERY_SUBSTEP} or you");
        return Err(refused(name, &accepted));
    }
    Law::named(name, parameters.pool.name()).map_err(|error| match error {
        FlockError::Parameter { accepted, .. } => refused(name, &accepted),
        other => other,
    })
}

/// A leader's observation in the default layout.
///
/// # Errors
/// Those of [`observe_flock`].
pub(crate) fn observed(flock: &Flock, rudders: &[f64], leader: usize) -> Result<Vec<f64>> {
    let layout = ObservationLayout::default();
    let observations = observe_flock(flock, layout, rudders)?;
    let observation = observations.chunks_exact(layout.size()).nth(leader);
    Ok(observation
        .unwrap_or_default()
        .iter()
        .map(|&x| x.into())
        .collect())
}
