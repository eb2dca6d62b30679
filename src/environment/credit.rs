//! Effects of a leader's contacts on normal boats, from the impulses of the contact solver. Unlike the order, they do
//! not contain the noise of boats that the leader does not touch.

use crate::geometry::LapFrame;
use crate::integrator::Integrator;
use crate::parameters::Target;

/// Time in s after which a turn by a leader counts for 1/e.
pub(super) const MEMORY_S: f64 = 4.0;

/// How one leader has turned one normal boat.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
struct Turned {
    /// Part of the boat's angular velocity that comes from the leader's impulses and has not decayed yet, in rad/s.
    spin: f64,
    /// Part of its heading that the leader turned, in rad.
    angle: f64,
}

/// One leader's credit for a control step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeaderCredit {
    /// Σ λ·(n·t̂): tangential momentum given towards the target, per time, in cm/s².
    pub push: f64,
    /// Σ Δα̇·sin δ: angular velocity given towards the target's tangent, per time, in rad/s².
    pub alignment: f64,
    /// Σ cos δ − cos(δ + turned angle): the order of touched boats minus their order without the turn.
    pub touched_order: f64,
}

/// The credit of a flock's leaders, and its memory.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct ContactCredit {
    leaders: usize,
    /// (momentum in cm/s, angular velocity in rad/s) that each leader gave to normal boats in the control step.
    transfers: Vec<(f64, f64)>,
    /// For each leader, an entry per normal boat.
    turned: Vec<Turned>,
}

impl ContactCredit {
    /// No credit yet, before the first contact.
    pub(super) fn new(leaders: usize, boats: usize) -> Self {
        Self {
            leaders,
            transfers: vec![(0.0, 0.0); leaders],
            turned: vec![Turned::default(); leaders * (boats - leaders)],
        }
    }

    /// Whether a stored credit has these numbers of leaders and boats.
    pub(super) fn fits(&self, leaders: usize, boats: usize) -> bool {
        self.leaders == leaders
            && self.transfers.len() == leaders
            && self.turned.len() == leaders * (boats - leaders)
    }

    /// Clears the momentum and angular velocity of the previous control step.
    pub(crate) fn start(&mut self) {
        self.transfers.fill((0.0, 0.0));
    }

    /// Adds the contacts of the substep just taken.
    pub(crate) fn add(&mut self, flock: &Integrator) {
        let normal = flock.poses.len() - self.leaders;
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
            let towards = flock.parameters.target.of(leader).sign();
            let push = frame.components(-contact.gap.normal * impulse).y;
            let spin = -contact.gap.arm_j * impulse * flock.inertia[boat].angular;
            // sin δ, where δ is how far counter-clockwise the boat has to turn.
            let misaligned = -towards * frame.components(flock.boats[boat].axis).x;
            let transfer = &mut self.transfers[leader];
            transfer.0 += towards * push;
            transfer.1 += spin * misaligned;
            self.turned[leader * normal + boat - self.leaders].spin += spin;
        }
    }

    /// Advances the turns by a control step: eq. (9) damps the spins, and the angles decay.
    pub(crate) fn remember(&mut self, flock: &Integrator, step_s: f64) {
        let normal = flock.poses.len() - self.leaders;
        if normal == 0 {
            return;
        }
        let forgetting = libm::exp(-step_s / MEMORY_S);
        let hulls = &flock.boats[self.leaders..];
        let velocities = &flock.velocities[self.leaders..];
        for turned in self.turned.chunks_exact_mut(normal) {
            for ((turned, hull), velocity) in turned.iter_mut().zip(hulls).zip(velocities) {
                if *turned == Turned::default() {
                    continue;
                }
                let along = hull.axis.dot(&velocity.linear);
                let rate = flock.motion.turn_damping(velocity.angular, along);
                turned.angle = forgetting * (turned.angle + turned.spin * step_s);
                turned.spin *= libm::exp(-rate * step_s);
            }
        }
    }

    /// The credit of a leader for a control step of this length.
    pub(crate) fn of(
        &self,
        leader: usize,
        flock: &Integrator,
        target: Target,
        step_s: f64,
    ) -> LeaderCredit {
        let normal = flock.poses.len() - self.leaders;
        let (push, alignment) = self.transfers[leader];
        let turned_by_leader = &self.turned[leader * normal..(leader + 1) * normal];
        let hulls = &flock.boats[self.leaders..];
        let gains = turned_by_leader.iter().zip(hulls).map(|(turned, hull)| {
            if turned.angle == 0.0 {
                return 0.0;
            }
            let orientation = LapFrame::at(hull.center).components(hull.axis);
            // sin δ and cos δ.
            let (sin, cos) = (
                -target.sign() * orientation.x,
                target.sign() * orientation.y,
            );
            let (turned_sin, turned_cos) = libm::sincos(turned.angle);
            cos - (cos * turned_cos - sin * turned_sin)
        });
        LeaderCredit {
            push: push / step_s,
            alignment: alignment / step_s,
            touched_order: gains.sum(),
        }
    }
}
