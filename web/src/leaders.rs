//! How leaders steer on the page: a policy, and one leader that the visitor may steer.

use flockenv::environment::observation::{FlockView, ObservationLayout, Observer};
use flockenv::parameters::FlockParameters;
use flockenv::policies::{Law, Pilot};
use flockenv::{Flock, FlockError, Result};

/// The paper's law at every substep, by the name that the command line has for it.
pub(crate) const EVERY_SUBSTEP: &str = "paper's law at every substep";

/// The policies, by the names that the command line has for them; `you` is the visitor.
pub(crate) const POLICIES: [&str; 5] = [EVERY_SUBSTEP, "paper's law", "tuned law", "learned", "you"];

/// Decisions per second of all policies but the law at every substep.
pub(crate) const CONTROL_HZ: f64 = 10.0;

/// How the leaders of a flock steer.
pub(crate) enum Leaders {
    /// By the paper's law at every substep.
    EverySubstep,
    /// By a law, at every decision.
    Law(Pilot),
    /// By the paper's law, but for leader 0, whose rudder is the visitor's.
    You(Pilot),
}

impl Leaders {
    /// The policy of this name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for unknown names, and flocks that the policy is not made for.
    pub fn named(name: &str, parameters: &FlockParameters) -> Result<Self> {
        let refuse = |accepted: &str| FlockError::parameter("leaders", name, accepted);
        let law = match name {
            EVERY_SUBSTEP => return Ok(Self::EverySubstep),
            "you" if parameters.n_leaders == 0 => {
                return Err(refuse("at least one leader, whom you steer"));
            }
            "you" => Law::Paper,
            _ if !POLICIES.contains(&name) => return Err(refuse(&POLICIES.join(", "))),
            _ => Law::named(name, parameters.pool.name())
                .map_err(|_| refuse("this law is for the pools that have a name"))?,
        };
        let pilot = Pilot::new(law, parameters, CONTROL_HZ)?;
        Ok(if name == "you" {
            Self::You(pilot)
        } else {
            Self::Law(pilot)
        })
    }

    /// The rudders from now on; `None` for the law at every substep.
    ///
    /// # Errors
    /// As for [`Pilot::rudders`].
    pub fn decide(&mut self, flock: &Flock, yours: f64) -> Result<Option<Vec<f64>>> {
        match self {
            Self::EverySubstep => Ok(None),
            Self::Law(pilot) => pilot.rudders(flock).map(Some),
            Self::You(pilot) => {
                let mut rudders = pilot.rudders(flock)?;
                rudders[0] = yours;
                Ok(Some(rudders))
            }
        }
    }
}

/// What a leader observes by default.
///
/// # Errors
/// Those of [`Observer::new`].
pub(crate) fn observed(flock: &Flock, rudders: &[f64], leader: usize) -> Result<Vec<f64>> {
    let layout = ObservationLayout::default();
    let mut observer = Observer::new(layout, flock.parameters())?;
    let mut all = vec![0.0; layout.size() * flock.parameters().n_leaders];
    let order = flock.order_parameters(false).ok();
    let view = FlockView::new(flock, rudders, order.as_ref());
    observer.observe(&view, &mut all);
    let own = all
        .chunks_exact(layout.size())
        .nth(leader)
        .unwrap_or_default();
    Ok(own.iter().map(|&number| f64::from(number)).collect())
}
