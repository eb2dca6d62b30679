//! How leaders steer on the page: a policy, and one leader that the visitor may steer.

use flockenv::boat::{Law, TUNED_LAWS};
use flockenv::environment::observation::{FlockView, LeaderLaw, ObservationLayout, Observer};
use flockenv::parameters::FlockParameters;
use flockenv::{Flock, FlockError, Result};

/// The policies, by the names that the command line has for them; `you` is the visitor.
pub(crate) const POLICIES: [&str; 3] = ["law", "tuned damped law", "you"];

/// Decisions per second of all policies but the law at every substep.
pub(crate) const CONTROL_HZ: f64 = 10.0;

/// How the leaders of a flock steer.
pub(crate) enum Leaders {
    /// By the paper's law at every substep.
    EverySubstep,
    /// By a law, evaluated from what they observe.
    Law(LeaderLaw),
    /// As `Law`, but for leader 0, whose rudder is the visitor's.
    You(LeaderLaw),
}

impl Leaders {
    /// The policy of this name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for unknown names, and flocks that the policy is not made for.
    pub fn named(name: &str, parameters: &FlockParameters) -> Result<Self> {
        let refuse = |accepted: &str| FlockError::parameter("leaders", name, accepted);
        match name {
            "law" => Ok(Self::EverySubstep),
            "tuned damped law" => {
                let pool = parameters.pool.name();
                let mut laws = TUNED_LAWS.iter();
                let tuned = laws.find(|(law, of, _)| *law == "damped law" && Some(*of) == pool);
                let (_, _, law) = tuned
                    .ok_or_else(|| refuse("the tuned law is for the pools that have a name"))?;
                Ok(Self::Law(LeaderLaw::new(*law, parameters)?))
            }
            "you" if parameters.n_leaders == 0 => {
                Err(refuse("at least one leader, whom you steer"))
            }
            "you" => Ok(Self::You(LeaderLaw::new(Law::Steering, parameters)?)),
            _ => Err(refuse(&POLICIES.join(", "))),
        }
    }

    /// The rudders from now on, given those that are held; `None` for the law at every substep.
    pub fn decide(&self, flock: &Flock, held: &[f64], yours: f64) -> Option<Vec<f64>> {
        let (Self::Law(law) | Self::You(law)) = self else {
            return None;
        };
        let rudders = viewed(flock, held, |view| {
            let leaders = 0..view.leaders;
            leaders
                .map(|leader| law.rudder(view, leader, 0.0))
                .collect::<Vec<_>>()
        });
        Some(match self {
            Self::You(_) => std::iter::once(yours)
                .chain(rudders.into_iter().skip(1))
                .collect(),
            _ => rudders,
        })
    }
}

/// What a function says of a flock as its leaders view it.
fn viewed<T>(flock: &Flock, rudders: &[f64], look: impl FnOnce(&FlockView) -> T) -> T {
    let parameters = flock.parameters();
    let order = flock.order_parameters(false).ok();
    look(&FlockView {
        poses: flock.poses(),
        hulls: flock.hulls(),
        velocities: flock.velocities(),
        leaders: parameters.n_leaders,
        phase: flock.phase(),
        bw_s: parameters.bw_s,
        targets: &parameters.target,
        rudders,
        order: order.as_ref(),
    })
}

/// What a leader observes by default.
///
/// # Errors
/// Those of [`Observer::new`].
pub(crate) fn observed(flock: &Flock, rudders: &[f64], leader: usize) -> Result<Vec<f64>> {
    let layout = ObservationLayout::default();
    let mut observer = Observer::new(layout, flock.parameters())?;
    let mut all = vec![0.0; layout.size() * flock.parameters().n_leaders];
    viewed(flock, rudders, |view| observer.observe(view, &mut all));
    let own = all
        .chunks_exact(layout.size())
        .nth(leader)
        .unwrap_or_default();
    Ok(own.iter().map(|&number| f64::from(number)).collect())
}
