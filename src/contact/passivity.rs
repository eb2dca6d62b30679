//! Frictionless plastic contacts never add energy to the boats that they join, except when they open an overlap.
//!
//! If biases follow from the present gaps alone, every solution obeys this, since boats at rest satisfy the constraints.
//! Biases may also look ahead: along the curve of a gap whose bodies pushed each other before, for a flank on a convex
//! wall, or by relinearization. Such biases demand too much if a boat turns far in one substep. The contact then passes
//! from one end of the hull to the other, and an impulse at the first end does not open the gap.

use super::ContactProblem;
use super::solver::ContactSolver;
use super::velocity_bias::VelocityBias;

/// Fraction of an island's energy that biases along a curve may add. Normally the fraction is of third order in dt. In
/// `wide` and `narrow`, free or jammed, at dt = 0.01 to 0.05 s, it exceeded 0.01 in 6 of 1.8 million islands.
const ALLOWED: f64 = 0.01;

/// A quick check whether contacts might add energy to boats. An impulse λ at a contact that its bias b opens at the speed −b
/// adds at most the energy −b·λ. The part of −b that undoes an overlap is subtracted.
pub(super) fn may_add_energy(
    problem: &ContactProblem,
    impulses: &[f64],
    bias: VelocityBias,
) -> bool {
    let adds_much = |k: usize| {
        let contact = &problem.contacts[k];
        let excess_speed = bias.for_gap(&contact.gap).min(0.0) - problem.biases[k];
        let energy = problem.energy(contact.boat as usize, problem.free);
        excess_speed > 0.0 && excess_speed * impulses[k] > ALLOWED * energy
    };
    (0..impulses.len()).any(|k| impulses[k] > 0.0 && adds_much(k))
}

/// Whether contacts push a boat's flank from opposite sides. With biases that look ahead, they would reverse the boat's
/// turn; a plastic impact only stops it.
fn turns_back(island: &[u32], problem: &ContactProblem, impulses: &[f64]) -> bool {
    let contacts = island.iter().map(|&k| k as usize);
    let pushed = contacts
        .filter(|&k| impulses[k] > 0.0)
        .map(|k| &problem.contacts[k]);
    let flanks: Vec<_> = pushed.filter(|contact| contact.gap.bend != 0.0).collect();
    let mut pairs = flanks
        .iter()
        .enumerate()
        .flat_map(|(k, a)| flanks[..k].iter().map(move |b| (a, b)));
    pairs.any(|(a, b)| a.boat == b.boat && a.gap.normal.dot(&b.gap.normal) < 0.0)
}

/// Finds the islands whose contacts add energy to boats.
#[derive(Debug, Clone, Default)]
pub(super) struct Passivity {
    /// Whether each boat's energy is already counted in its island's.
    is_counted: Vec<bool>,
}

impl Passivity {
    /// Indices of all contacts of each island whose contacts add energy to boats, or reverse a boat's turn between
    /// obstacles.
    #[cold]
    pub(super) fn driven_contacts(
        &mut self,
        solver: &ContactSolver,
        problem: &ContactProblem,
        bias: VelocityBias,
        has_obstacles: bool,
    ) -> Vec<usize> {
        self.is_counted.clear();
        self.is_counted.resize(problem.free.len(), false);
        let islands = (0..solver.islands().count()).map(|island| solver.islands().contacts(island));
        let driven = islands.filter(|island| {
            self.is_driven(island, solver, problem, bias)
                || has_obstacles && turns_back(island, problem, &solver.impulses)
        });
        driven.flatten().map(|&k| k as usize).collect()
    }

    /// Whether the contacts of an island add more energy to its boats than opening overlaps takes. `island` lists the
    /// contacts' indices.
    fn is_driven(
        &mut self,
        island: &[u32],
        solver: &ContactSolver,
        problem: &ContactProblem,
        bias: VelocityBias,
    ) -> bool {
        let (mut energy_before, mut energy_after) = (0.0, 0.0);
        for &k in island {
            let contact = &problem.contacts[k as usize];
            let boats = [Some(contact.boat as usize), contact.second()];
            for boat in boats.into_iter().flatten() {
                if !std::mem::replace(&mut self.is_counted[boat], true) {
                    energy_before += problem.energy(boat, problem.free);
                    energy_after += problem.energy(boat, &solver.velocities);
                }
            }
            // Opening an overlap may add energy.
            let opening_speed = (-bias.for_gap(&contact.gap)).max(0.0);
            energy_before += solver.impulses[k as usize] * opening_speed;
        }
        energy_after > (1.0 + ALLOWED) * energy_before
    }
}
