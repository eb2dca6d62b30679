//! The contact problem of one substep: the smallest change of velocity, in the metric of effective
//! inertia, after which no gap closes beyond zero.

use super::Contact;
use crate::geometry::Velocity;

/// One over the effective inertia of a boat in this substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseInertia {
    /// Per unit mass; 1 if drag is explicit.
    pub linear: f64,
    /// In 1/cm²; 1/ρ² if damping is explicit.
    pub angular: f64,
}

/// min Σ (v − v_free)ᵀ M (v − v_free) subject to J·v + bias ≥ 0, with bias = gap/dt. Its dual is the
/// complementarity problem w = A·λ + b ≥ 0, λ ≥ 0, w·λ = 0 with A = J·M⁻¹·Jᵀ and b = J·v_free + bias.
#[derive(Debug, Clone, Copy)]
pub struct ContactProblem<'a> {
    /// The contacts, one row of J each.
    pub contacts: &'a [Contact],
    /// Effective inertia of every boat.
    pub inertia: &'a [InverseInertia],
    /// Velocity of every boat without contacts.
    pub free: &'a [Velocity],
    /// Velocity bias of each contact: how fast its gap may close, in cm/s.
    pub biases: &'a [f64],
}

impl ContactProblem<'_> {
    /// w_k = J_k·v + bias_k: the gap at the substep's end, over dt.
    #[inline(always)]
    pub fn slack(&self, k: usize, velocities: &[Velocity]) -> f64 {
        self.contacts[k].gap_rate(velocities) + self.biases[k]
    }

    /// Applies an impulse at contact k to the velocities.
    #[inline(always)]
    pub(crate) fn apply(&self, k: usize, impulse: f64, velocities: &mut [Velocity]) {
        let contact = &self.contacts[k];
        let gap = &contact.gap;
        let i = contact.boat as usize;
        let inertia = &self.inertia[i];
        velocities[i].linear += gap.normal * (impulse * inertia.linear);
        velocities[i].angular += gap.arm_i * impulse * inertia.angular;
        if let Some(j) = contact.second() {
            let inertia = &self.inertia[j];
            velocities[j].linear -= gap.normal * (impulse * inertia.linear);
            velocities[j].angular -= gap.arm_j * impulse * inertia.angular;
        }
    }

    /// Resets the velocities of these contacts' boats to the free ones.
    // Not inlined: inlining slows down islands that do not need it.
    #[inline(never)]
    pub(crate) fn reset_velocities(&self, contacts: &[u32], velocities: &mut [Velocity]) {
        for &k in contacts {
            let contact = &self.contacts[k as usize];
            let first = contact.boat as usize;
            velocities[first] = self.free[first];
            if let Some(second) = contact.second() {
                velocities[second] = self.free[second];
            }
        }
    }

    /// A_kk: how much an impulse at contact k opens its own gap.
    #[inline]
    pub(crate) fn diagonal(&self, k: usize) -> f64 {
        let contact = &self.contacts[k];
        let gap = &contact.gap;
        let first = &self.inertia[contact.boat as usize];
        let first_part = first.linear + gap.arm_i * gap.arm_i * first.angular;
        match contact.second() {
            None => first_part,
            Some(j) => {
                let second = &self.inertia[j];
                first_part + second.linear + gap.arm_j * gap.arm_j * second.angular
            }
        }
    }

    /// A_kl: how much an impulse at contact k opens the gap of contact l.
    pub(crate) fn coupling(&self, k: usize, l: usize) -> f64 {
        let mut sum = 0.0;
        for (boat, normal, arm) in self.contacts[k].sides() {
            for (other, other_normal, other_arm) in self.contacts[l].sides() {
                if boat == other {
                    let inertia = &self.inertia[boat as usize];
                    sum += normal.dot(&other_normal) * inertia.linear
                        + arm * other_arm * inertia.angular;
                }
            }
        }
        sum
    }

    /// Kinetic energy of a boat in the metric of effective inertia, in cm²/s² (mass 1).
    pub(crate) fn energy(&self, boat: usize, velocities: &[Velocity]) -> f64 {
        let Velocity { linear, angular } = velocities[boat];
        let inertia = &self.inertia[boat];
        0.5 * (linear.norm_squared() / inertia.linear + angular * angular / inertia.angular)
    }

    /// Natural residual max|min(A_kk·λ_k, w_k)| of impulses and the velocities they give, in cm/s: 0
    /// exactly at a solution.
    pub(crate) fn natural_residual(&self, impulses: &[f64], velocities: &[Velocity]) -> f64 {
        (0..self.contacts.len())
            .map(|k| {
                (self.diagonal(k) * impulses[k])
                    .min(self.slack(k, velocities))
                    .abs()
            })
            .fold(0.0, f64::max)
    }

    /// Fills `velocities` with those after these impulses.
    pub fn velocities(&self, impulses: &[f64], velocities: &mut Vec<Velocity>) {
        velocities.clear();
        velocities.extend_from_slice(self.free);
        for (k, &impulse) in impulses.iter().enumerate() {
            if impulse != 0.0 {
                self.apply(k, impulse, velocities);
            }
        }
    }
}
