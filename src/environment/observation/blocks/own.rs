//! The block of the leader itself: its position, orientation, velocity and rudder.

use super::super::entry::{Entry, Scale, TWICE, UNIT};
use super::super::view::FlockView;
use super::{LeaderView, WriteBlock};
use crate::boat::misalignment;
use crate::geometry::LapFrame;

/// The leader itself.
#[rustfmt::skip]
pub(crate) const OWN: [Entry; 8] = [
    Entry::new("radial_position", "cm", Scale::Radial, (-1.1, 1.1), "distance from the pool's center"),
    Entry::new("cos_orientation", "", Scale::Plain, UNIT, "cosine of the LAP orientation: 1 heads at the outer wall"),
    Entry::new("sin_orientation", "", Scale::Plain, UNIT, "sine of the LAP orientation: 1 heads clockwise").odd(),
    Entry::new("outward_velocity", "cm/s", Scale::Speed, TWICE, "velocity away from the pool's center"),
    Entry::new("clockwise_velocity", "cm/s", Scale::Speed, TWICE, "tangential velocity, positive clockwise").odd(),
    Entry::new("forward_velocity", "cm/s", Scale::Speed, TWICE, "velocity along the heading; a rudder works in reverse where it is negative"),
    Entry::new("clockwise_spin", "rad/s", Scale::AngularVelocity, TWICE, "angular velocity, positive clockwise").odd(),
    Entry::new("rudder", "", Scale::Plain, UNIT, "the rudder as it stands, positive turns counter-clockwise when moving forward").odd(),
];

/// Writes [`OWN`].
#[derive(Debug, Clone, Default)]
pub(super) struct Own;

impl WriteBlock for Own {
    fn write(&mut self, view: &LeaderView, _repeats: usize, physical: &mut Vec<f64>) {
        physical.extend(own_values(view.flock, view.leader, &view.frame));
    }
}

/// The physical values of [`OWN`].
pub(crate) fn own_values(view: &FlockView, leader: usize, frame: &LapFrame) -> [f64; OWN.len()] {
    let (pose, velocity) = (&view.poses[leader], &view.velocities[leader]);
    let (cos, sin) = orientation(view, leader, frame);
    let lap_velocity = frame.components(velocity.linear);
    [
        pose.position.norm(),
        cos,
        sin,
        lap_velocity.x,
        lap_velocity.y,
        view.hulls[leader].axis.dot(&velocity.linear),
        -velocity.angular,
        view.rudders.get(leader).copied().unwrap_or_default(),
    ]
}

/// Cosine and sine of the LAP orientation φ.
///
/// If the leader heads exactly against the target, up to rounding, both are computed from the steering law's
/// misalignment δ = φ − φ_target. So a law that reads the observation turns to the same side as the steering law, whose
/// δ jumps from π to −π there.
fn orientation(view: &FlockView, leader: usize, frame: &LapFrame) -> (f64, f64) {
    let orientation = frame.components(view.hulls[leader].axis);
    let target = view.targets.of(leader);
    let is_against_target = orientation.x.abs() <= 1e-9 && target.sign() * orientation.y <= 0.0;
    if !is_against_target {
        return (orientation.x, orientation.y);
    }
    let pose = &view.poses[leader];
    let (sin, cos) = libm::sincos(misalignment(pose.position, pose.heading, target));
    (-target.sign() * sin, target.sign() * cos)
}
