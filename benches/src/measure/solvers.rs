//! The contact problem alone: the problems of consecutive steps of a jam, rebuilt from its poses and
//! velocities, solved by each solver from the impulses of the step before.

use super::Effort;
use crate::Scene;
use crate::configuration::STEP_S;
use crate::table::{Table, median, number, quartiles, text};
use flockenv::boat::{Drive, FreeMotion};
use flockenv::contact::solver::{ContactSolver, SolveReport};
use flockenv::contact::{Contact, ContactDetector, ContactProblem, InverseInertia};
use flockenv::geometry::{HullPose, Vec2, Velocity};
use flockenv::parameters::Solver;
use flockenv::{Flock, FlockParameters};
use std::time::Instant;

/// Gap in cm of the deepest overlap that the solver closes.
const DEEP: f64 = -0.01;

/// One step's problem.
pub(super) struct Problem {
    contacts: Vec<Contact>,
    inertia: Vec<InverseInertia>,
    free: Vec<Velocity>,
    bounds: Vec<f64>,
    /// Impulses of the same contacts in the step before.
    pub(super) guess: Vec<f64>,
}

/// Whether two contacts are between the same features of the same bodies.
fn is_same_contact(a: &Contact, b: &Contact) -> bool {
    (a.boat, a.partner, a.feature) == (b.boat, b.partner, b.feature)
}

impl Problem {
    /// The problem of the next step of a flock in a jam.
    pub(super) fn of_next_step(flock: &Flock) -> Self {
        let p = flock.parameters();
        let boats: Vec<HullPose> = flock.poses().iter().map(HullPose::new).collect();
        let (free, inertia) = without_contacts(p, &boats, flock.velocities());
        let mut detector = ContactDetector::new(p);
        let mut contacts = Vec::new();
        detector.detect_moving(&boats, &free, p.dt_s, &mut contacts);
        let bound = |contact: &Contact| {
            let (gap, spin) = (contact.gap, free[contact.boat as usize].angular);
            let closing = gap.gap / p.dt_s + 0.5 * gap.bend * p.dt_s * spin * spin;
            if gap.gap < DEEP { 0.0 } else { closing }
        };
        let before = flock.contacts();
        let carried = |contact: &Contact| {
            let known = before
                .iter()
                .find(|known| is_same_contact(&known.contact, contact));
            known.map_or(0.0, |known| known.force * p.dt_s)
        };
        Self {
            bounds: contacts.iter().map(bound).collect(),
            guess: contacts.iter().map(carried).collect(),
            contacts,
            inertia,
            free,
        }
    }

    /// Solves from the guess.
    pub(super) fn solve(&self, solver: &mut ContactSolver) -> SolveReport {
        solver.impulses.clone_from(&self.guess);
        solver.active.clear();
        solver
            .active
            .extend(self.guess.iter().map(|&impulse| impulse > 0.0));
        solver.reset(self.free.len(), &self.contacts);
        solver.solve(&ContactProblem {
            contacts: &self.contacts,
            inertia: &self.inertia,
            free: &self.free,
            biases: &self.bounds,
        })
    }
}

/// Velocities without contacts and effective inverse inertia of a leapfrog step, without noise.
pub(super) fn without_contacts(
    parameters: &FlockParameters,
    boats: &[HullPose],
    velocities: &[Velocity],
) -> (Vec<Velocity>, Vec<InverseInertia>) {
    let motion = FreeMotion::new(parameters);
    let drive = Drive {
        preferred_speed: parameters.speed_cm_s,
        rudder: 0.0,
        water: Vec2::zeros(),
        noise: 0.0,
    };
    let moment = parameters.gyration_radius_cm.powi(2);
    let boat = |(boat, velocity): (&HullPose, &Velocity)| {
        let free = motion.centered(velocity, boat.axis, &drive, Vec2::zeros(), parameters.dt_s);
        let inertia = InverseInertia {
            linear: motion.linear_mobility(parameters.dt_s),
            angular: free.angular_mobility / moment,
        };
        (free.velocity, inertia)
    };
    boats.iter().zip(velocities).map(boat).unzip()
}

/// A jam that has nearly come to rest against the wall.
pub(super) fn jam(boats: usize) -> Flock {
    let parameters = FlockParameters {
        dt_s: STEP_S,
        ..Scene::Jam.parameters(boats)
    };
    let mut flock = Flock::new(parameters, 1).expect("the boats fit");
    flock.advance(20.0, None).expect("the motion stays finite");
    flock
}

fn problems(boats: usize, count: usize) -> Vec<Problem> {
    let mut flock = jam(boats);
    let next = |_| {
        flock
            .advance(STEP_S, None)
            .expect("the motion stays finite");
        Problem::of_next_step(&flock)
    };
    (0..count).map(next).collect()
}

/// The mean time of a solver for a problem in µs, and its reports.
fn solve_all(problems: &[Problem], kind: Solver) -> (f64, Vec<SolveReport>) {
    let mut solver = ContactSolver::new(kind);
    let start = Instant::now();
    let reports: Vec<_> = problems
        .iter()
        .map(|problem| problem.solve(&mut solver))
        .collect();
    (
        start.elapsed().as_secs_f64() * 1e6 / problems.len() as f64,
        reports,
    )
}

/// Measures every solver on jams of every size; solvers take turns.
pub fn measure(effort: Effort) -> Table {
    let mut table = Table::new(&[
        "solver",
        "n",
        "problems",
        "contacts",
        "us_per_solve",
        "us_q1",
        "us_q3",
        "residual_median",
        "residual_worst",
        "iterations",
    ]);
    for boats in [27, 50, 200, 1000] {
        let count = effort.choose(10, 12_000 / boats).min(200);
        let problems = problems(boats, count);
        let turns = effort.choose(2, if boats < 1000 { 9 } else { 5 });
        let mut times = vec![Vec::new(); Solver::ALL.len()];
        let mut reports = vec![Vec::new(); Solver::ALL.len()];
        for _ in 0..turns {
            for (index, &kind) in Solver::ALL.iter().enumerate() {
                let (time, solver_reports) = solve_all(&problems, kind);
                times[index].push(time);
                reports[index] = solver_reports;
            }
        }
        for (index, kind) in Solver::ALL.iter().enumerate() {
            let cells = row(boats, &problems, &times[index], &reports[index]);
            table.row([vec![text(kind.name())], cells].concat());
        }
    }
    table
}

fn row(boats: usize, problems: &[Problem], times: &[f64], reports: &[SolveReport]) -> Vec<String> {
    let mean = |sum: usize| number(sum as f64 / problems.len() as f64);
    let residuals: Vec<f64> = reports.iter().map(|report| report.residual).collect();
    let [q1, middle, q3] = quartiles(times);
    vec![
        text(boats),
        text(problems.len()),
        mean(problems.iter().map(|problem| problem.contacts.len()).sum()),
        number(middle),
        number(q1),
        number(q3),
        number(median(&residuals)),
        number(residuals.iter().copied().fold(0.0, f64::max)),
        mean(
            reports
                .iter()
                .map(|report| report.iterations as usize)
                .sum(),
        ),
    ]
}
