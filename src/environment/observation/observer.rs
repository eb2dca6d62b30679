//! Observers, which compute the numbers that leaders and critics get from a flock.

use super::blocks::{Block, LeaderView, Writers, phase_values};
use super::entry::BOAT;
use super::view::{FlockView, Scaling};
use super::{ObservationLayout, state_entries};
use crate::error::Result;
use crate::flock::Flock;
use crate::geometry::LapFrame;
use crate::parameters::FlockParameters;

/// Observations of all leaders of a flock without an environment, one leader after another. `rudders` are the leaders'
/// present rudders.
///
/// # Errors
/// As for [`Observer::new`], and [`crate::FlockError::Parameter`] if the layout needs the order of normal boats in a
/// flock without normal boats.
pub fn observe_flock(
    flock: &Flock,
    layout: ObservationLayout,
    rudders: &[f64],
) -> Result<Vec<f32>> {
    let parameters = flock.parameters();
    let order = flock.order_parameters(Flock::WITHOUT_LEADERS);
    let needs_order = layout.has(Block::Order) || layout.has(Block::LeanFeatures);
    let order = if needs_order {
        Some(order?)
    } else {
        order.ok()
    };
    let view = FlockView::new(flock, rudders, order.as_ref());
    let mut out = vec![0.0; parameters.n_leaders * layout.size()];
    Observer::new(layout, parameters)?.observe(&view, &mut out);
    Ok(out)
}

/// Writes observations of one flock's leaders.
#[derive(Debug, Clone)]
pub struct Observer {
    layout: ObservationLayout,
    scaling: Scaling,
    writers: Writers,
    /// Scratch memory: the physical values of one leader's observation.
    physical: Vec<f64>,
}

impl Observer {
    /// An observer for a checked layout and checked parameters.
    ///
    /// # Errors
    /// [`crate::FlockError::Parameter`] for blocks that cannot describe the flock, such as `lean_features` in a pool in
    /// which these features are not standardized.
    pub fn new(layout: ObservationLayout, parameters: &FlockParameters) -> Result<Self> {
        let entries = layout.entries().into_iter().map(|(_, _, entry)| entry);
        let scaling = Scaling::new(entries, parameters);
        Ok(Self {
            physical: Vec::with_capacity(scaling.len()),
            scaling,
            writers: Writers::new(|block| layout.repeats(block), parameters)?,
            layout,
        })
    }

    /// The layout.
    pub fn layout(&self) -> &ObservationLayout {
        &self.layout
    }

    /// Writes the leaders' observations one after another, `layout().size()` numbers each. Returns how many numbers were
    /// clipped at their bounds.
    pub fn observe(&mut self, view: &FlockView, out: &mut [f32]) -> u32 {
        let mut clipped = 0;
        for (leader, row) in out.chunks_exact_mut(self.scaling.len()).enumerate() {
            self.physical.clear();
            let leader_view = LeaderView::new(view, leader);
            self.writers.write(&leader_view, &mut self.physical);
            let is_mirrored = self.layout.is_mirrored && view.targets.of(leader).sign() < 0.0;
            clipped += self.scaling.write(&self.physical, is_mirrored, row);
        }
        clipped
    }
}

/// Writes the global state of one flock, for critics that see everything.
#[derive(Debug, Clone)]
pub(crate) struct StateObserver {
    boats: usize,
    /// Scaling of one boat's entries.
    boat_scaling: Scaling,
    /// Scaling of the entries after the boats: phase, target and clock.
    common_scaling: Scaling,
    mirror_to_target: bool,
}

impl StateObserver {
    /// An observer for checked parameters, mirrored like the observations of leader 0.
    pub(crate) fn new(parameters: &FlockParameters, mirror_to_target: bool) -> Self {
        let common_entries = state_entries(0).into_iter();
        Self {
            boats: parameters.n_boats,
            boat_scaling: Scaling::new(BOAT.into_iter(), parameters),
            common_scaling: Scaling::new(common_entries, parameters),
            mirror_to_target,
        }
    }

    /// Number of entries of the global state.
    pub(crate) fn size(&self) -> usize {
        self.boats * self.boat_scaling.len() + self.common_scaling.len()
    }

    /// Writes the state; `elapsed` is the fraction of the episode that is over.
    pub(crate) fn observe(&self, view: &FlockView, elapsed: f64, out: &mut [f32]) {
        let is_mirrored = self.mirror_to_target && view.targets.reference().sign() < 0.0;
        let boat_size = self.boat_scaling.len();
        let (boat_rows, common) = out.split_at_mut(self.boats * boat_size);
        for (boat, row) in boat_rows.chunks_exact_mut(boat_size).enumerate() {
            let state = boat_state(view, boat);
            self.boat_scaling.write(&state, is_mirrored, row);
        }
        let mut physical = phase_values(view).to_vec();
        physical.extend([view.targets.mean_sign(view.leaders), elapsed]);
        self.common_scaling.write(&physical, is_mirrored, common);
    }
}

/// The physical values of [`BOAT`].
fn boat_state(view: &FlockView, boat: usize) -> [f64; BOAT.len()] {
    let (pose, velocity) = (&view.poses[boat], &view.velocities[boat]);
    let frame = LapFrame::at(pose.position);
    let orientation = frame.components(view.hulls[boat].axis);
    let lap_velocity = frame.components(velocity.linear);
    [
        pose.position.norm(),
        frame.outward.x,
        frame.outward.y,
        orientation.x,
        orientation.y,
        lap_velocity.x,
        lap_velocity.y,
        -velocity.angular,
        view.rudders.get(boat).copied().unwrap_or_default(),
        f64::from(u8::from(boat < view.leaders)),
    ]
}
