//! Order parameters of the normal boats.

use super::super::entry::{Entry, Scale, TWICE, UNIT};
use super::super::view::FlockView;
use super::{LeaderView, WriteBlock};

/// Order parameters of the normal boats, as vectors in LAP axes.
#[rustfmt::skip]
pub(super) const ORDER: [Entry; 4] = [
    Entry::new("mean_cos_orientation", "", Scale::Plain, UNIT, "mean orientation, outward part: psi_o*cos(phi_o)"),
    Entry::new("mean_sin_orientation", "", Scale::Plain, UNIT, "mean orientation, clockwise part: psi_o*sin(phi_o)").odd(),
    Entry::new("mean_outward_velocity", "cm/s", Scale::Speed, TWICE, "mean velocity, outward part: psi_v*cos(phi_v)"),
    Entry::new("mean_clockwise_velocity", "cm/s", Scale::Speed, TWICE, "mean velocity, clockwise part: psi_v*sin(phi_v)").odd(),
];

/// Writes [`ORDER`], which is the same for every leader: computes it for leader 0 and repeats it for the others.
#[derive(Debug, Clone, Default)]
pub(super) struct Order([f64; ORDER.len()]);

impl WriteBlock for Order {
    fn write(&mut self, view: &LeaderView, _repeats: usize, physical: &mut Vec<f64>) {
        if view.leader == 0 {
            self.0 = order_values(view.flock);
        }
        physical.extend_from_slice(&self.0);
    }
}

/// The values of [`ORDER`]; zeros if there are no normal boats.
fn order_values(view: &FlockView) -> [f64; ORDER.len()] {
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
