//! Frictionless plastic contacts take energy out of the boats that they join, or leave it; only what
//! opens an overlap adds some.
//!
//! With biases that follow from the gaps at hand alone, every solution obeys: rest satisfies them. Biases
//! that look ahead along a curve, for a flank on the inner wall or by relinearization, may demand more
//! where a boat turns far in one substep: the contact has then passed from one end of the hull to the
//! other, and pushing as at the substep's start opens nothing.

use super::ContactProblem;
use super::velocity_bias::VelocityBias;
use crate::geometry::Velocity;

/// Part of an island's energy that a curve may seem to add. Its true share is of third order in dt: in
/// wide and `narrow`, free or jammed, below 0.01 at dt = 0.01 to 0.05 s in all but 6 of
/// 1.8 million islands.
const ALLOWED: f64 = 0.01;

/// Whether contacts might drive a boat, checked quickly: an impulse λ at a contact that opens at the speed
/// −b adds at most −b·λ.
pub(super) fn may_drive(problem: &ContactProblem, impulses: &[f64], bias: VelocityBias) -> bool {
    let adds_much = |k: usize| {
        let contact = &problem.contacts[k];
        let ahead = bias.of_gap(&contact.gap).min(0.0) - problem.biases[k];
        let energy = problem.energy(contact.boat as usize, problem.free);
        ahead > 0.0 && ahead * impulses[k] > ALLOWED * energy
    };
    (0..impulses.len()).any(|k| impulses[k] > 0.0 && adds_much(k))
}

/// Finds islands that contacts drive, with its scratch space.
#[derive(Debug, Clone, Default)]
pub(super) struct Passivity {
    counted: Vec<bool>,
}

impl Passivity {
    /// For a new set of contacts of so many boats.
    pub(super) fn reset(&mut self, boats: usize) {
        self.counted.clear();
        self.counted.resize(boats, false);
    }

    /// Whether the contacts of an island, given by their numbers, add to the energy of its boats, beyond
    /// what opening overlaps takes.
    pub(super) fn is_driven(
        &mut self,
        island: &[u32],
        problem: &ContactProblem,
        impulses: &[f64],
        velocities: &[Velocity],
        bias: VelocityBias,
    ) -> bool {
        let (mut before, mut after) = (0.0, 0.0);
        for &k in island {
            let contact = &problem.contacts[k as usize];
            let boats = [Some(contact.boat as usize), contact.second()];
            for boat in boats.into_iter().flatten() {
                if !std::mem::replace(&mut self.counted[boat], true) {
                    before += problem.energy(boat, problem.free);
                    after += problem.energy(boat, velocities);
                }
            }
            before += impulses[k as usize] * (-bias.of_gap(&contact.gap)).max(0.0);
        }
        after > (1.0 + ALLOWED) * before
    }
}
