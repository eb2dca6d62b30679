//! Moves overlapping hulls apart without giving them any speed.
//!
//! A deep overlap must not enter the velocity constraint: g + dt·J·v ≥ 0 would eject a 5 cm overlap at 250 cm/s (dt =
//! 0.02 s). Deep overlaps are therefore undone by moving poses alone, by the least Σ|Δx|² + ρ²ΣΔα² for which the
//! linearized gaps open.

use super::solver::ContactSolver;
use super::{Contact, ContactDetector, ContactProblem, InverseInertia};
use crate::geometry::{HullPose, Pose, Velocity, cross, smaller};
use crate::parameters::FlockParameters;

/// Overlaps beyond this, in boat radii (0.01 cm of 5), are undone by moving poses; smaller ones are left
/// to the velocities.
pub(super) const PENETRATION_SLOP: f64 = 0.002;
/// The most by which one pass opens a gap or moves a boat, in boat radii (1 cm of 5). Linearized gaps do not hold for
/// longer steps. A boat turns by at most 1 rad.
const LARGEST_STEP: f64 = 0.2;

/// Number of passes after which a substep accepts the remaining overlaps.
const MOST_PASSES: u32 = 8;

/// Called now and then during long work. The work ends if it returns false.
pub type KeepGoing<'a> = &'a (dyn Fn() -> bool + Sync);

/// Projects poses to open gaps, with its scratch space.
#[derive(Debug, Clone)]
pub(super) struct Depenetration {
    pub(super) solver: ContactSolver,
    contacts: Vec<Contact>,
    biases: Vec<f64>,
    /// Velocities of boats at rest.
    rest_velocities: Vec<Velocity>,
    inertia: Vec<InverseInertia>,
    boat_inertia: InverseInertia,
    largest_step_cm: f64,
    /// Passes made so far.
    pub passes: u64,
}

impl Depenetration {
    /// A projection for checked parameters.
    pub(super) fn new(parameters: &FlockParameters) -> Self {
        let gyration_radius = parameters.gyration_radius_cm;
        Self {
            // Regularized, since a dense packing may have no solution. Then the contacts share the remaining overlap.
            solver: ContactSolver::regularized(1e-4),
            contacts: Vec::new(),
            biases: Vec::new(),
            rest_velocities: Vec::new(),
            inertia: Vec::new(),
            boat_inertia: InverseInertia {
                linear: 1.0,
                angular: 1.0 / (gyration_radius * gyration_radius),
            },
            largest_step_cm: LARGEST_STEP * parameters.boat_radius_cm,
            passes: 0,
        }
    }

    /// Displaces poses until no overlap exceeds `allowed` (cm, positive), or for [`MOST_PASSES`]. At least one overlap
    /// exceeds `allowed` at first. Then fills `contacts` as [`ContactDetector::detect`] does with `margin` (cm).
    pub(super) fn open_overlaps(
        &mut self,
        detector: &mut ContactDetector,
        poses: &mut [Pose],
        boats: &mut Vec<HullPose>,
        allowed: f64,
        margin: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let wide = wide_margin(detector);
        for _ in 0..MOST_PASSES {
            detector.detect(boats, wide, &mut self.contacts);
            self.displace(poses, boats);
            // The neighbor list is updated for the wide margin even if no pass follows. The order of contacts, and so the
            // last bits of the results, depends on when the list is rebuilt.
            detector.update(boats, wide);
            detector.detect(boats, margin.min(wide), contacts);
            if smallest_gap(contacts) >= -allowed || self.solver.is_exhausted() {
                break;
            }
        }
        if margin > wide {
            detector.detect(boats, margin, contacts);
        }
    }

    /// Moves poses once, to open the overlaps of `self.contacts`.
    fn displace(&mut self, poses: &mut [Pose], boats: &mut Vec<HullPose>) {
        self.passes += 1;
        self.rest_velocities
            .resize(poses.len(), Velocity::default());
        self.inertia.resize(poses.len(), self.boat_inertia);
        let gaps = self.contacts.iter().map(|contact| contact.gap.gap);
        self.biases.clear();
        self.biases
            .extend(gaps.map(|gap| gap.max(-self.largest_step_cm)));
        let overlap = self.biases.iter().map(|&gap| gap < 0.0);
        self.solver.active.clear();
        self.solver.active.extend(overlap);
        self.solver.impulses.clear();
        self.solver.impulses.resize(self.contacts.len(), 0.0);
        self.solver.reset(poses.len(), &self.contacts);
        let problem = ContactProblem {
            contacts: &self.contacts,
            inertia: &self.inertia,
            free: &self.rest_velocities,
            biases: &self.biases,
        };
        self.solver.solve(&problem);
        // For a time of 1, velocities are displacements.
        for (pose, step) in poses.iter_mut().zip(&self.solver.velocities) {
            let relative_size = (step.linear.norm() / self.largest_step_cm).max(step.angular.abs());
            if relative_size.is_finite() {
                *pose = pose.moved(step, 1.0 / relative_size.max(1.0));
            }
        }
        HullPose::replace_all(boats, poses);
    }
}

/// The margin of [`ContactDetector::detect`] in cm for a pass. Contacts within it take part, so that the pass pushes no
/// hull into another.
fn wide_margin(detector: &ContactDetector) -> f64 {
    0.5 * detector.hull().radius
}

/// The smallest gap in cm; infinite without contacts.
pub(super) fn smallest_gap(contacts: &[Contact]) -> f64 {
    contacts.iter().fold(f64::INFINITY, |smallest, contact| {
        smaller(smallest, contact.gap.gap)
    })
}

/// Σx×v about the pool's center, the part of the angular momentum that changes if poses alone move, in cm²/s.
pub(super) fn orbital_angular_momentum(poses: &[Pose], velocities: &[Velocity]) -> f64 {
    let pairs = poses.iter().zip(velocities);
    pairs
        .map(|(pose, velocity)| cross(pose.position, velocity.linear))
        .sum()
}

/// Moves hulls apart during placement until none overlaps, for at most `most_passes` or until `keep_going` returns
/// false.
pub(crate) fn push_apart(
    detector: &mut ContactDetector,
    poses: &mut [Pose],
    parameters: &FlockParameters,
    most_passes: u32,
    keep_going: KeepGoing,
) {
    let mut boats = Vec::with_capacity(poses.len());
    HullPose::replace_all(&mut boats, poses);
    let mut projection = Depenetration::new(parameters);
    let margin = wide_margin(detector);
    for _ in 0..most_passes {
        detector.detect(&boats, margin, &mut projection.contacts);
        if smallest_gap(&projection.contacts) >= 0.0 || !keep_going() {
            return;
        }
        projection.solver.refill(poses.len());
        projection.displace(poses, &mut boats);
    }
}
