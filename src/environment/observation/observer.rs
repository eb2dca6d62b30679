//! From a flock to the numbers that leaders and critics get.

use super::blocks::{Block, Seen, Writers, phase};
use super::entry::BOAT;
use super::view::{FlockView, Scaling};
use super::{ObservationLayout, state_entries};
use crate::error::Result;
use crate::flock::Flock;
use crate::geometry::LapFrame;
use crate::parameters::FlockParameters;

/// Observations of a flock's leaders without an environment, one after another, given the rudders as they stand.
///
/// # Errors
/// As for [`Observer::new`], and [`crate::FlockError::Parameter`] if the layout has the order of normal boats and there
/// are none.
pub fn observe_flock(
    flock: &Flock,
    layout: ObservationLayout,
    rudders: &[f64],
) -> Result<Vec<f32>> {
    let parameters = flock.parameters();
    let order = flock.order_parameters(false);
    let needed = layout.has(Block::Order) || layout.has(Block::LeanFeatures);
    let order = if needed { Some(order?) } else { order.ok() };
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
    physical: Vec<f64>,
}

impl Observer {
    /// An observer for a checked layout and checked parameters.
    ///
    /// # Errors
    /// [`crate::FlockError::Parameter`] for blocks that cannot serve the flock, such as `lean_features` in a pool in
    /// which they are not standardized.
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

    /// Writes the leaders' observations one after another, `layout().size()` numbers each; returns how
    /// many numbers were clipped at their bounds.
    pub fn observe(&mut self, view: &FlockView, out: &mut [f32]) -> u32 {
        let mut clipped = 0;
        for (leader, row) in out.chunks_exact_mut(self.scaling.len()).enumerate() {
            self.physical.clear();
            let seen = Seen::new(view, leader);
            self.writers.write(&seen, &mut self.physical);
            let mirrored = self.layout.is_mirrored && view.targets.of(leader).sign() < 0.0;
            clipped += self.scaling.write(&self.physical, mirrored, row);
        }
        clipped
    }
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
    /// An observer for checked parameters, mirrored like the observations of leader 0.
    pub(crate) fn new(parameters: &FlockParameters, mirror_to_target: bool) -> Self {
        let rest = state_entries(0).into_iter();
        Self {
            boats: parameters.n_boats,
            boat: Scaling::new(BOAT.into_iter(), parameters),
            rest: Scaling::new(rest, parameters),
            mirror_to_target,
        }
    }

    /// Number of features.
    pub(crate) fn size(&self) -> usize {
        self.boats * self.boat.len() + self.rest.len()
    }

    /// Writes the state; `elapsed` is the fraction of the episode that is over.
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
