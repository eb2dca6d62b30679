//! Drives of boats in a substep: motors, rudders and the water.

use super::phase_schedule::Phase;
use super::state::Integrator;
use super::substep::{Steering, Substep};
use crate::boat::{Drive, misalignment, steering_law};
use crate::geometry::{Vec2, turned_left};

impl Integrator {
    /// Preferred speed of normal boats in a phase, in cm/s, without the spread between boats.
    fn normal_speed(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Forward => self.parameters.speed_cm_s,
            Phase::Backward => -self.parameters.reverse_speed_cm_s,
            Phase::DriftAfterForward | Phase::DriftAfterBackward => 0.0,
        }
    }

    /// Preferred speed of leaders in a phase, in cm/s, without the spread between boats.
    fn leader_speed(&self, phase: Phase) -> f64 {
        let p = &self.parameters;
        let is_stopped = phase == Phase::Backward && !p.leaders_reverse;
        let speed = if is_stopped {
            0.0
        } else {
            self.normal_speed(phase)
        };
        speed * p.leader_speed_factor
    }

    /// Preferred speed of a boat in a phase, in cm/s.
    pub(super) fn preferred_speed(&self, boat: usize, phase: Phase) -> f64 {
        let speed = if boat < self.parameters.n_leaders {
            self.leader_speed(phase)
        } else {
            self.normal_speed(phase)
        };
        self.speed_factors
            .get(boat)
            .map_or(speed, |factor| speed * factor)
    }

    /// Rudder of a boat: a leader's follows from the command or the law, a normal boat's is the turning bias.
    pub(super) fn rudder(&self, boat: usize, steering: Steering) -> f64 {
        if boat >= self.parameters.n_leaders {
            return self.parameters.turning_bias;
        }
        match steering {
            Steering::Held(commands) => commands[boat],
            Steering::Law => self.paper_rudder(boat),
        }
    }

    /// The paper's rudder command for a boat in its present pose, eq. (10).
    pub(crate) fn paper_rudder(&self, boat: usize) -> f64 {
        let pose = &self.poses[boat];
        steering_law(misalignment(
            pose.position,
            pose.heading,
            self.parameters.target.of(boat),
        ))
    }

    /// Fills `drives` for a substep: preferred speed and rudder of its phase, noise, and the water's motion `ahead_s`
    /// after the time of the present velocities.
    pub(super) fn fill_drives(&mut self, substep: &Substep, ahead_s: f64) {
        let normal = Drive {
            preferred_speed: self.normal_speed(substep.phase),
            rudder: self.parameters.turning_bias,
            water: Vec2::zeros(),
            noise: 0.0,
        };
        self.drives.clear();
        self.drives.extend(
            self.noise_increments
                .iter()
                .map(|&noise| Drive { noise, ..normal }),
        );
        for leader in 0..self.parameters.n_leaders {
            self.drives[leader].preferred_speed = self.leader_speed(substep.phase);
            self.drives[leader].rudder = self.rudder(leader, substep.steering);
        }
        for (drive, factor) in self.drives.iter_mut().zip(&self.speed_factors) {
            drive.preferred_speed *= factor;
        }
        self.fill_water(ahead_s, |state, boat| state.velocities[boat].linear);
    }

    /// Sets the water's velocity in `drives` to that `ahead_s` after the time of the present velocities. `velocity` gives
    /// the velocities of the boats that drive the water. The water moves counter-clockwise at −κ·(mean tangential
    /// velocity of the boats), capped (Section 4.5). Water with inertia approaches that speed exponentially.
    pub(super) fn fill_water(&mut self, ahead_s: f64, velocity: impl Fn(&Self, usize) -> Vec2) {
        if self.parameters.current_gain == 0.0 && self.water_cm_s == 0.0 {
            return;
        }
        self.driven_water_cm_s = self.driven_water(velocity);
        let current = self.water_after(ahead_s);
        for boat in 0..self.poses.len() {
            self.drives[boat].water = self.tangent(boat) * current;
        }
    }

    /// Speed in cm/s that the water would have after a long time, if boats kept these velocities.
    fn driven_water(&self, velocity: impl Fn(&Self, usize) -> Vec2) -> f64 {
        let sum: f64 = (0..self.poses.len())
            .map(|boat| velocity(self, boat).dot(&self.tangent(boat)))
            .sum();
        let cap = self.parameters.current_cap_cm_s;
        (-self.parameters.current_gain * sum / self.poses.len() as f64).clamp(-cap, cap)
    }

    /// Speed of the water in cm/s after it has approached the driven speed for a time.
    fn water_after(&self, seconds: f64) -> f64 {
        let relaxation_s = self.parameters.current_relaxation_s;
        if relaxation_s == 0.0 {
            return self.driven_water_cm_s;
        }
        let approach = -libm::expm1(-seconds / relaxation_s);
        self.water_cm_s + approach * (self.driven_water_cm_s - self.water_cm_s)
    }

    /// Advances the speed of water with inertia by a time, after a substep was taken.
    pub(super) fn move_water(&mut self, seconds: f64) {
        if self.parameters.current_relaxation_s > 0.0 {
            self.water_cm_s = self.water_after(seconds);
        }
    }

    /// Takes over the water's speed from a flock with other parameters, if this water has inertia.
    pub(crate) fn keep_water(&mut self, water_cm_s: f64) {
        if self.parameters.current_relaxation_s > 0.0 {
            let cap = self.parameters.current_cap_cm_s;
            self.water_cm_s = water_cm_s.clamp(-cap, cap);
        }
    }

    /// Speed of the water in cm/s at the time of the velocities, counter-clockwise positive.
    pub(crate) fn current_cm_s(&self) -> f64 {
        if self.parameters.current_relaxation_s > 0.0 {
            return self.water_cm_s;
        }
        self.driven_water(|state, boat| state.velocities[boat].linear)
    }

    /// Counter-clockwise unit tangent at a boat; zero at the pool's center.
    fn tangent(&self, boat: usize) -> Vec2 {
        let position = self.poses[boat].position;
        turned_left(position.try_normalize(0.0).unwrap_or_default())
    }
}
