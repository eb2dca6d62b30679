//! Effects of a leader's contacts on normal boats, from the impulses of the contact solver. Unlike the order, these
//! effects are free of the noise of boats that the leader does not touch.

use crate::geometry::{HullPose, LapFrame};
use crate::integrator::Integrator;
use crate::parameters::Target;

/// Time in s after which the credit for a turn has decayed to 1/e.
pub(super) const MEMORY_S: f64 = 4.0;

/// How one leader has turned one normal boat.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
struct Turned {
    /// Part of the boat's angular velocity that comes from the leader's impulses and has not decayed yet, in rad/s.
    spin: f64,
    /// Angle by which the leader turned the boat's heading, decayed with [`MEMORY_S`], in rad.
    angle: f64,
}

/// One leader's credit for a control step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeaderCredit {
    /// Σ λ·(n·t̂): tangential momentum given towards the target, per time, in cm/s².
    pub push: f64,
    /// Σ Δα̇·sin δ: angular velocity given towards the target's tangent, per time, in rad/s².
    pub alignment: f64,
    /// Σ [cos δ − cos(δ + turned angle)]: the order of touched boats minus their order without the leader's turns.
    pub touched_order: f64,
}

/// Effects of the contacts of all leaders of a flock.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct ContactCredit {
    /// Number of leaders.
    leaders: usize,
    /// For each leader, the (momentum in cm/s, angular velocity in rad/s) given to normal boats towards the target in
    /// the present control step.
    transfers: Vec<(f64, f64)>,
    /// For each leader, one entry per normal boat.
    turned: Vec<Turned>,
}

impl ContactCredit {
    /// The credit before the first contact: zero.
    pub(super) fn new(leaders: usize, boats: usize) -> Self {
        Self {
            leaders,
            transfers: vec![(0.0, 0.0); leaders],
            turned: vec![Turned::default(); leaders * (boats - leaders)],
        }
    }

    /// Bytes of the turns of these numbers of leaders and boats.
    pub(super) fn bytes(leaders: usize, boats: usize) -> u64 {
        (size_of::<Turned>() * leaders * (boats - leaders)) as u64
    }

    /// Whether a stored credit is for these numbers of leaders and boats.
    pub(super) fn fits(&self, leaders: usize, boats: usize) -> bool {
        self.leaders == leaders
            && self.transfers.len() == leaders
            && self.turned.len() == leaders * (boats - leaders)
    }

    /// Clears the momentum and angular velocity of the previous control step.
    pub(crate) fn start_step(&mut self) {
        self.transfers.fill((0.0, 0.0));
    }

    /// Adds the effects of the contacts in the substep just taken.
    pub(crate) fn add_contacts(&mut self, flock: &Integrator) {
        let normal_boats = flock.poses.len() - self.leaders;
        let contacts = flock.contacts.contacts.iter();
        for (contact, &impulse) in contacts.zip(&flock.contacts.solver.impulses) {
            let Some(boat) = contact.second().filter(|_| impulse > 0.0) else {
                continue;
            };
            // Leaders come first, and a contact's boat has a lower index than its partner.
            let leader = contact.boat as usize;
            if leader >= self.leaders || boat < self.leaders {
                continue;
            }
            let frame = LapFrame::at(flock.poses[boat].position);
            let target_sign = flock.parameters.target.of(leader).sign();
            let push = frame.components(-contact.gap.normal * impulse).y;
            let spin = -contact.gap.arm_j * impulse * flock.inertia[boat].angular;
            // δ is the counter-clockwise angle by which the boat has to turn to head along the target.
            let sin_delta = -target_sign * frame.components(flock.boats[boat].axis).x;
            let (momentum, angular_velocity) = &mut self.transfers[leader];
            *momentum += target_sign * push;
            *angular_velocity += spin * sin_delta;
            self.turned[leader * normal_boats + boat - self.leaders].spin += spin;
        }
    }

    /// Advances the turns by a control step: eq. (9) damps the spins, and the angles decay.
    pub(crate) fn advance_turns(&mut self, flock: &Integrator, step_s: f64) {
        let normal_boats = flock.poses.len() - self.leaders;
        if normal_boats == 0 {
            return;
        }
        let decay = libm::exp(-step_s / MEMORY_S);
        let hulls = &flock.boats[self.leaders..];
        let velocities = &flock.velocities[self.leaders..];
        for turned_by_leader in self.turned.chunks_exact_mut(normal_boats) {
            let boats = turned_by_leader.iter_mut().zip(hulls).zip(velocities);
            for ((turned, hull), velocity) in boats {
                if *turned == Turned::default() {
                    continue;
                }
                let forward_cm_s = hull.axis.dot(&velocity.linear);
                let damping = flock.motion.turn_damping(velocity.angular, forward_cm_s);
                turned.angle = decay * (turned.angle + turned.spin * step_s);
                turned.spin *= libm::exp(-damping * step_s);
            }
        }
    }

    /// The credit of a leader for the present control step, which takes `step_s`.
    pub(crate) fn of_leader(
        &self,
        leader: usize,
        flock: &Integrator,
        target: Target,
        step_s: f64,
    ) -> LeaderCredit {
        let normal_boats = flock.poses.len() - self.leaders;
        let (momentum, angular_velocity) = self.transfers[leader];
        let turned_by_leader = &self.turned[leader * normal_boats..(leader + 1) * normal_boats];
        let hulls = &flock.boats[self.leaders..];
        let order_gains = turned_by_leader
            .iter()
            .zip(hulls)
            .map(|(turned, hull)| order_gain(turned.angle, hull, target));
        LeaderCredit {
            push: momentum / step_s,
            alignment: angular_velocity / step_s,
            touched_order: order_gains.sum(),
        }
    }
}

/// cos δ − cos(δ + `angle`): the order of a boat minus its order without a turn by `angle` (rad).
fn order_gain(angle: f64, hull: &HullPose, target: Target) -> f64 {
    if angle == 0.0 {
        return 0.0;
    }
    let orientation = LapFrame::at(hull.center).components(hull.axis);
    let sin_delta = -target.sign() * orientation.x;
    let cos_delta = target.sign() * orientation.y;
    let (sin_angle, cos_angle) = libm::sincos(angle);
    cos_delta - (cos_delta * cos_angle - sin_delta * sin_angle)
}
