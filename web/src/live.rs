//! A flock that continues for as long as the page shows it.

use crate::leaders::{CONTROL_HZ, Leaders, observed};
use crate::request::Request;
use flockenv::analysis::quantities::{Formula, QUANTITIES, Quantity};
use flockenv::contact::{Partner, Statistics};
use flockenv::flock::{Change, Sampling};
use flockenv::integrator::Steering;
use flockenv::parameters::{FlockParameters, Value};
use flockenv::{Flock, FlockError, Result};

/// The longest run that is sampled, in s.
const LONGEST_S: f64 = 1e9;

/// The samples since the last call of `take`: time in s, phase (0 to 3), whether it is in the analysis window, poses,
/// velocities, rudders and quantities. Then the [`statistics`] at the last sample, the present contacts that carry a force
/// (boats, −1 for a wall; position along the core in cm; direction as a vector; force in cm/s²), and the present
/// observation of a leader.
pub(crate) type Columns = [Vec<f64>; 10];

/// The quantities of a sample, in the order of the table.
pub(crate) fn quantities() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES
        .iter()
        .filter(|quantity| !matches!(quantity.formula, Formula::Structure(_)))
}

/// Present values of [`quantities`]; NaN if the flock has no normal boats.
fn measured(flock: &Flock) -> impl Iterator<Item = f64> {
    let recorded = flock.recorded(Flock::WITHOUT_LEADERS).ok();
    let order = flock.order_parameters(Flock::WITHOUT_LEADERS).ok();
    let target = flock.parameters().target.reference();
    quantities()
        .enumerate()
        .map(move |(index, quantity)| match quantity.formula {
            Formula::Derived(formula) => order.map_or(f64::NAN, |order| formula(&order, target)),
            // Recorded quantities come first in the table, so that they have the same index in `recorded`.
            _ => recorded.map_or(f64::NAN, |recorded| recorded[index]),
        })
}

/// Names and values of the statistics that say whether overlaps stayed within the tolerance.
pub(crate) fn statistics(statistics: &Statistics) -> Vec<(String, Value)> {
    match statistics.named_overlaps() {
        Value::Map(values) => values,
        _ => Vec::new(),
    }
}

/// A statistic as a number.
fn number(value: &Value) -> f64 {
    match value {
        Value::Count(count) => *count as f64,
        Value::Real(real) => *real,
        _ => f64::NAN,
    }
}

/// A flock with its leaders, sampled at the rate of decisions.
pub(crate) struct Live {
    flock: Flock,
    leaders: Leaders,
    /// The rudders until the next decision; `None` for the law at every substep.
    next_rudders: Option<Vec<f64>>,
    /// The heading that the visitor sets, clockwise from outward, divided by π.
    heading: f64,
    sampling: Sampling,
    /// Number of samples since the start of the run.
    samples_taken: u64,
    columns: Columns,
}

impl Live {
    /// Starts a flock, and takes its first sample.
    ///
    /// # Errors
    /// As for [`Flock::new`] and [`Request::leaders`].
    pub fn new(request: Request) -> Result<Self> {
        let leaders = request.leaders()?;
        let mut live = Self {
            flock: Flock::new(request.parameters, request.seed)?,
            leaders,
            next_rudders: None,
            heading: 0.0,
            sampling: Sampling::new(LONGEST_S, CONTROL_HZ)?,
            samples_taken: 0,
            columns: Columns::default(),
        };
        live.start_steering();
        live.sample()?;
        Ok(live)
    }

    /// The flock's parameters.
    pub fn parameters(&self) -> &FlockParameters {
        self.flock.parameters()
    }

    /// The columns of the samples.
    pub fn columns(&mut self) -> &mut Columns {
        &mut self.columns
    }

    /// Changes the flock as requested. It continues from its present state if that is possible, and otherwise restarts.
    /// Returns whether it continued.
    ///
    /// # Errors
    /// As for [`Live::new`]; the flock is unchanged then.
    pub fn change(&mut self, request: Request) -> Result<bool> {
        let leaders = request.leaders()?;
        let (old, new) = (self.parameters(), &request.parameters);
        let continues = request.seed == self.flock.seed()
            && new.n_boats == old.n_boats
            && new.pool.has_outer_wall() == old.pool.has_outer_wall();
        let mut retargeted = old.clone();
        retargeted.target.clone_from(&new.target);
        // As in a schedule in Python, new parameters restart the random streams unless only the target differs.
        let change = if retargeted == *new {
            Change::Target(new.target.clone())
        } else {
            Change::Parameters(Box::new(new.clone()))
        };
        if !continues || (new != old && self.flock.change(&change).is_err()) {
            *self = Self::new(request)?;
            return Ok(false);
        }
        self.leaders = leaders;
        self.start_steering();
        // The leaders decide again, since they made the decisions of this moment before the change.
        let present_rudders = self.present_rudders();
        self.next_rudders = self
            .leaders
            .decide(&self.flock, &present_rudders, self.heading)?;
        Ok(true)
    }

    /// Keeps the rudders until the next decision, or sets them amidships if the number of leaders has changed. Removes them
    /// for the law at every substep.
    fn start_steering(&mut self) {
        let holds_rudders = !matches!(self.leaders, Leaders::EverySubstep);
        let amidships = vec![0.0; self.parameters().n_leaders];
        let kept_rudders = self
            .next_rudders
            .take()
            .filter(|rudders| rudders.len() == amidships.len());
        self.next_rudders = holds_rudders.then(|| kept_rudders.unwrap_or(amidships));
    }

    /// Sets the visitor's heading from the next decision on: clockwise from outward, divided by π.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a heading beyond −1 and 1.
    pub fn steer(&mut self, heading: f64) -> Result<()> {
        if !(-1.0..=1.0).contains(&heading) {
            return Err(FlockError::parameter(
                "heading",
                heading,
                "a number in [-1, 1]",
            ));
        }
        self.heading = heading;
        Ok(())
    }

    /// Takes some samples within a work limit in substeps times boats, and returns their number.
    ///
    /// # Errors
    /// [`FlockError::Solver`] if numbers left their range, and those of [`Leaders::decide`].
    pub fn advance(&mut self, samples: u32, boat_substeps: u64) -> Result<u32> {
        let start = self.flock.statistics().substeps;
        let boats = self.parameters().n_boats as u64;
        let mut taken = 0;
        while taken < samples {
            let work = (self.flock.statistics().substeps - start) * boats;
            if work >= boat_substeps {
                break;
            }
            let steering = self
                .next_rudders
                .as_deref()
                .map_or(Steering::Law, Steering::Held);
            let end = self.sampling.time(self.samples_taken);
            let stop = self.flock.stop_towards(end, boat_substeps - work);
            self.flock.advance_to(&|| true, stop, steering)?;
            if stop == end {
                self.sample()?;
                taken += 1;
            }
        }
        Ok(taken)
    }

    /// Takes a sample, then lets the leaders decide.
    fn sample(&mut self) -> Result<()> {
        let present_rudders = self.present_rudders();
        let flock = &self.flock;
        let [
            time,
            phase,
            analyzed,
            poses,
            velocities,
            rudders,
            series,
            statistics_column,
            ..,
        ] = &mut self.columns;
        time.push(flock.time_s());
        phase.push(flock.phase().phase.index() as f64);
        let is_analyzed = flock.schedule().in_analysis_window(flock.time());
        analyzed.push(f64::from(u8::from(is_analyzed)));
        for pose in flock.poses() {
            poses.extend([pose.position.x, pose.position.y, pose.heading]);
        }
        for velocity in flock.velocities() {
            velocities.extend([velocity.linear.x, velocity.linear.y, velocity.angular]);
        }
        rudders.extend(&present_rudders);
        series.extend(measured(flock));
        let named = statistics(flock.statistics());
        *statistics_column = named.iter().map(|(_, value)| number(value)).collect();
        self.samples_taken += 1;
        self.next_rudders = self.leaders.decide(flock, &present_rudders, self.heading)?;
        Ok(())
    }

    /// The leaders' present rudders.
    fn present_rudders(&self) -> Vec<f64> {
        let rudders_of_law = || {
            let leaders = 0..self.parameters().n_leaders;
            leaders
                .map(|leader| self.flock.steering_law(leader))
                .collect()
        };
        self.next_rudders.clone().unwrap_or_else(rudders_of_law)
    }

    /// Fills the columns of the present contacts and of a leader's observation.
    ///
    /// # Errors
    /// Those of [`observed`].
    pub fn look(&mut self, boat: usize) -> Result<()> {
        let observation = if boat < self.parameters().n_leaders {
            observed(&self.flock, &self.present_rudders(), boat)?
        } else {
            Vec::new()
        };
        let mut contacts = Vec::new();
        let loaded_contacts = self.flock.contacts().into_iter();
        for loaded in loaded_contacts.filter(|loaded| loaded.force > 0.0) {
            let contact = &loaded.contact;
            let partner = match contact.partner {
                Partner::Boat(boat) => f64::from(boat),
                Partner::OuterWall | Partner::InnerWall | Partner::Obstacle(_) => -1.0,
            };
            let normal = contact.gap.normal;
            contacts.extend([
                f64::from(contact.boat),
                partner,
                contact.gap.along,
                normal.x,
                normal.y,
                loaded.force,
            ]);
        }
        let [.., contact_column, observation_column] = &mut self.columns;
        (*contact_column, *observation_column) = (contacts, observation);
        Ok(())
    }
}
