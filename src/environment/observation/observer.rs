//! From a flock to the numbers that leaders and critics get.

use super::entry::{BOAT, NEIGHBOR, ORDER, PHASE};
use super::fellow_leaders::FellowLeaders;
use super::nearest::Nearest;
use super::nearest_obstacles::NearestObstacles;
use super::view::{FlockView, Scaling, own, phase};
use super::{LeaderLaw, ObservationLayout, state_entries};
use crate::error::Result;
use crate::flock::Flock;
use crate::geometry::{LapFrame, Vec2, cross};
use crate::parameters::FlockParameters;

/// What the leaders of a flock observe without an environment, one after another, given the rudders as they stand.
///
/// # Errors
/// As for [`Observer::new`], and [`crate::FlockError::Parameter`] where the layout has the order of no boat.
pub fn observe_flock(
    flock: &Flock,
    layout: ObservationLayout,
    rudders: &[f64],
) -> Result<Vec<f32>> {
    let parameters = flock.parameters();
    let order = flock.order_parameters(false);
    let order = if layout.order {
        Some(order?)
    } else {
        order.ok()
    };
    let view = FlockView {
        poses: flock.poses(),
        hulls: flock.hulls(),
        velocities: flock.velocities(),
        leaders: parameters.n_leaders,
        phase: flock.phase(),
        bw_s: parameters.bw_s,
        targets: &parameters.target,
        rudders,
        order: order.as_ref(),
    };
    let mut out = vec![0.0; parameters.n_leaders * layout.size()];
    Observer::new(layout, parameters)?.observe(&view, &mut out);
    Ok(out)
}

/// Writes observations of one flock's leaders.
#[derive(Debug, Clone)]
pub struct Observer {
    layout: ObservationLayout,
    scaling: Scaling,
    law: Option<LeaderLaw>,
    physical: Vec<f64>,
    nearest: Nearest,
    obstacles: NearestObstacles,
    fellows: FellowLeaders,
}

impl Observer {
    /// For a checked layout and checked parameters.
    ///
    /// # Errors
    /// [`crate::FlockError::Parameter`] for `law_rudder` in a pool in which the law has not been tuned.
    pub fn new(layout: ObservationLayout, parameters: &FlockParameters) -> Result<Self> {
        let entries = layout.entries().into_iter().map(|(_, _, entry)| entry);
        let scaling = Scaling::new(entries, parameters);
        let law = layout.law(parameters)?;
        let law = law.map(|law| LeaderLaw::new(law, parameters)).transpose()?;
        Ok(Self {
            law,
            physical: Vec::with_capacity(scaling.len()),
            scaling,
            nearest: Nearest::default(),
            obstacles: NearestObstacles::new(parameters),
            fellows: FellowLeaders::default(),
            layout,
        })
    }

    /// The layout.
    pub fn layout(&self) -> &ObservationLayout {
        &self.layout
    }

    /// Writes the leaders' observations one after another, `layout().size()` numbers each; returns how
    /// many numbers were clipped at their bounds.
    pub fn observe(&mut self, view: &FlockView, out: &mut [f32]) -> u32 {
        let mut clipped = 0;
        let (phase, order) = (phase(view), order(view));
        for (leader, row) in out.chunks_exact_mut(self.scaling.len()).enumerate() {
            self.physical.clear();
            self.fill(view, leader, &phase, &order);
            let mirrored = self.layout.mirror_to_target && view.targets.of(leader).sign() < 0.0;
            clipped += self.scaling.write(&self.physical, mirrored, row);
        }
        clipped
    }

    fn fill(
        &mut self,
        view: &FlockView,
        leader: usize,
        phase: &[f64; PHASE.len()],
        order: &[f64; ORDER.len()],
    ) {
        let frame = LapFrame::at(view.poses[leader].position);
        if self.layout.own {
            self.physical.extend(own(view, leader, &frame));
        }
        if self.layout.phase {
            self.physical.extend_from_slice(phase);
        }
        if self.layout.target {
            self.physical.push(view.targets.of(leader).sign());
        }
        if self.layout.neighbors > 0 {
            self.fill_neighbors(view, leader, &frame);
        }
        if self.layout.order {
            self.physical.extend_from_slice(order);
        }
        if let Some(law) = &self.law {
            self.physical.push(law.rudder(view, leader, 0.0));
        }
        if self.layout.obstacles > 0 {
            let (hull, wanted) = (&view.hulls[leader], self.layout.obstacles);
            self.obstacles
                .fill(hull, &frame, wanted, &mut self.physical);
        }
        if self.layout.fellow_leaders > 0 {
            let wanted = self.layout.fellow_leaders;
            self.fellows.fill(view, leader, wanted, &mut self.physical);
        }
    }

    fn fill_neighbors(&mut self, view: &FlockView, leader: usize, frame: &LapFrame) {
        let own = &view.hulls[leader];
        let wanted = self.layout.neighbors;
        let filled = self.physical.len() + wanted * NEIGHBOR.len();
        for boat in self.nearest.of_leader(view.hulls, leader, wanted) {
            let other = &view.hulls[boat];
            let distance = frame.components(other.center - own.center);
            let velocity = frame.components(view.velocities[boat].linear);
            self.physical.extend([
                1.0,
                distance.x,
                distance.y,
                own.axis.dot(&other.axis),
                -cross(own.axis, other.axis),
                velocity.x,
                velocity.y,
                f64::from(u8::from(boat < view.leaders)),
            ]);
        }
        self.physical.resize(filled, 0.0);
    }
}

fn order(view: &FlockView) -> [f64; ORDER.len()] {
    let Some(order) = view.order else {
        return [0.0; ORDER.len()];
    };
    let ((sin_o, cos_o), (sin_v, cos_v)) = (libm::sincos(order.phi_o), libm::sincos(order.phi_v));
    [
        order.psi_o * cos_o,
        order.psi_o * sin_o,
        order.psi_v * cos_v,
        order.psi_v * sin_v,
    ]
}

/// Writes the global state of one flock, for critics that see everything.
#[derive(Debug, Clone)]
pub(crate) struct StateObserver {
    boats: usize,
    boat: Scaling,
    rest: Scaling,
    mirror_to_target: bool,
}

impl StateObserver {
    /// For checked parameters; mirrored like the observations of leader 0.
    pub(crate) fn new(parameters: &FlockParameters, mirror_to_target: bool) -> Self {
        let rest = state_entries(0).into_iter();
        Self {
            boats: parameters.n_boats,
            boat: Scaling::new(BOAT.into_iter(), parameters),
            rest: Scaling::new(rest, parameters),
            mirror_to_target,
        }
    }

    /// How many numbers there are.
    pub(crate) fn size(&self) -> usize {
        self.boats * self.boat.len() + self.rest.len()
    }

    /// Writes the state; `elapsed` is the part of the episode that is over.
    pub(crate) fn observe(&self, view: &FlockView, elapsed: f64, out: &mut [f32]) {
        let mirrored = self.mirror_to_target && view.targets.reference().sign() < 0.0;
        let (boats, rest) = out.split_at_mut(self.boats * self.boat.len());
        for (boat, row) in boats.chunks_exact_mut(self.boat.len()).enumerate() {
            self.boat.write(&boat_state(view, boat), mirrored, row);
        }
        let mut physical = phase(view).to_vec();
        physical.extend([view.targets.mean_sign(view.leaders), elapsed]);
        self.rest.write(&physical, mirrored, rest);
    }
}

fn boat_state(view: &FlockView, boat: usize) -> [f64; BOAT.len()] {
    let (pose, velocity) = (&view.poses[boat], &view.velocities[boat]);
    let frame = LapFrame::at(pose.position);
    let orientation = frame.components(view.hulls[boat].axis);
    let lap_velocity = frame.components(velocity.linear);
    let polar: Vec2 = frame.outward;
    let is_leader = boat < view.leaders;
    [
        pose.position.norm(),
        polar.x,
        polar.y,
        orientation.x,
        orientation.y,
        lap_velocity.x,
        lap_velocity.y,
        -velocity.angular,
        view.rudders.get(boat).copied().unwrap_or_default(),
        f64::from(u8::from(is_leader)),
    ]
}
