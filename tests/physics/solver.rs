//! The contact problem min ½(v − v_free)ᵀM(v − v_free), J·v + bound ≥ 0, is solved exactly: the natural
//! residual max|min(A_kk·λ_k, w_k)| is at most 1e-10 cm/s whenever the constraints can be met.
//!
//! On paper: one contact closing at v with bound 0 takes λ = v/A. In general: dense solutions by
//! enumeration and by Goldfarb and Idnani, which share nothing with the solver.

use crate::dense_reference::{Dense, Reference};
use crate::support::{RHO, cases};
use flockenv::contact::solver::{ContactSolver, SolveReport};
use flockenv::contact::{Contact, ContactProblem, InverseInertia, Partner};
use flockenv::geometry::{Feature, Gap, Vec2, Velocity};
use flockenv::parameters::Solver;
use nalgebra::DVector;
use proptest::prelude::*;
use std::f64::consts::PI;

/// What a [`ContactProblem`] borrows.
#[derive(Debug, Clone, Default)]
pub struct Owned {
    pub contacts: Vec<Contact>,
    pub inertia: Vec<InverseInertia>,
    pub free: Vec<Velocity>,
    pub biases: Vec<f64>,
}

impl Owned {
    pub fn problem(&self) -> ContactProblem<'_> {
        ContactProblem {
            contacts: &self.contacts,
            inertia: &self.inertia,
            free: &self.free,
            biases: &self.biases,
        }
    }

    /// Every contact so many times.
    pub fn repeated(&self, times: usize) -> Self {
        Self {
            contacts: self.contacts.repeat(times),
            biases: self.biases.repeat(times),
            ..self.clone()
        }
    }

    pub fn solve(&self, kind: Solver) -> (SolveReport, Vec<f64>, Vec<Velocity>) {
        let mut solver = ContactSolver::new(kind);
        solver.active = vec![false; self.contacts.len()];
        solver.impulses = vec![0.0; self.contacts.len()];
        solver.reset(self.free.len(), &self.contacts);
        let report = solver.solve(&self.problem());
        (report, solver.impulses, solver.velocities)
    }
}

pub const PLAIN: InverseInertia = InverseInertia {
    linear: 1.0,
    angular: 1.0 / (RHO * RHO),
};

pub fn contact(boat: u32, second: Option<u32>, angle: f64, arms: (f64, f64)) -> Contact {
    Contact {
        boat,
        partner: second.map_or(Partner::OuterWall, Partner::Boat),
        feature: Feature::Bow,
        gap: Gap {
            gap: 0.0,
            normal: Vec2::new(angle.cos(), angle.sin()),
            along: 0.0,
            along_j: 0.0,
            arm_i: arms.0,
            arm_j: if second.is_some() { arms.1 } else { 0.0 },
            bend: 0.0,
        },
    }
}

#[test]
fn one_contact_on_paper() {
    for kind in [Solver::BlockPivoting, Solver::GaussSeidel] {
        for (arm, closing, bound) in [
            (0.0, 6.0, 0.0),
            (2.0, 6.0, 1.5),
            (-2.5, 3.0, -0.5),
            (1.0, 2.0, 4.0),
        ] {
            let scene = Owned {
                contacts: vec![contact(0, None, 0.0, (arm, 0.0))],
                inertia: vec![PLAIN],
                free: vec![Velocity::new(-closing, 1.0, 0.0)],
                biases: vec![bound],
            };
            let (report, impulses, velocities) = scene.solve(kind);
            let expected = (closing - bound).max(0.0) / (1.0 + (arm / RHO).powi(2));
            assert!((impulses[0] - expected).abs() < 1e-11);
            assert!((velocities[0].linear.x + closing - expected).abs() < 1e-11);
            assert!(report.converged && report.residual <= 1e-10 && report.islands == 1);
        }
    }
}

#[test]
fn every_contact_three_times_gives_the_same_motion() {
    // A row of five against a wall, pushed: the redundant contacts share the joints' impulses.
    let mut scene = Owned {
        inertia: vec![PLAIN; 5],
        free: vec![Velocity::new(-1.0, 0.2, 0.1); 5],
        ..Owned::default()
    };
    scene.contacts.push(contact(0, None, 0.0, (0.7, 0.0)));
    scene
        .contacts
        .extend((0..4).map(|i| contact(i, Some(i + 1), PI, (0.3, -0.4))));
    scene.biases = vec![0.0; 5];
    let (_, impulses, velocities) = scene.solve(Solver::BlockPivoting);
    assert!(impulses.iter().all(|&impulse| impulse > 0.0));
    let (report, tripled, same) = scene.repeated(3).solve(Solver::BlockPivoting);
    assert!(report.converged && report.residual <= 1e-10, "{report:?}");
    for (a, b) in velocities.iter().zip(&same) {
        assert!((a.linear - b.linear).norm() < 1e-9 && (a.angular - b.angular).abs() < 1e-9);
    }
    for (k, impulse) in impulses.iter().enumerate() {
        let sum = tripled[k] + tripled[k + 5] + tripled[k + 10];
        assert!((sum - impulse).abs() < 1e-8);
    }
}

/// A boat in a channel exactly as wide as itself: two normals that are each other's opposite.
fn between_walls(free: Velocity, bias: f64) -> Owned {
    Owned {
        contacts: [PI, 0.0]
            .map(|angle| contact(0, None, angle, (0.0, 0.0)))
            .to_vec(),
        inertia: vec![PLAIN],
        free: vec![free],
        biases: vec![bias; 2],
    }
}

#[test]
fn opposite_contacts_hold_a_boat_still() {
    for (push, kept) in [(5.0, 0), (-5.0, 1)] {
        let scene = between_walls(Velocity::new(push, 3.0, 0.0), 0.0);
        let (report, impulses, velocities) = scene.solve(Solver::BlockPivoting);
        assert!(report.residual <= 1e-10);
        assert!((velocities[0].linear - Vec2::new(0.0, 3.0)).norm() < 1e-10);
        assert!((impulses[kept] - 5.0).abs() < 1e-9 && impulses[1 - kept].abs() < 1e-9);
    }
}

#[test]
fn constraints_that_contradict_each_other_are_reported() {
    // Two walls that both want the boat to come at 1 cm/s.
    let scene = between_walls(Velocity::default(), -1.0);
    for kind in Solver::ALL.iter().copied() {
        let (report, impulses, velocities) = scene.solve(kind);
        assert!(!report.converged, "{kind:?}: {report:?}");
        assert!(report.residual > 0.1, "{kind:?}: {report:?}");
        assert!(impulses.iter().all(|impulse| impulse.is_finite()));
        assert!(velocities.iter().all(Velocity::is_finite));
    }
}

fn velocity() -> impl Strategy<Value = Velocity> {
    (-20.0..20.0_f64, -20.0..20.0_f64, -3.0..3.0_f64).prop_map(|(x, y, w)| Velocity::new(x, y, w))
}

fn inertia() -> impl Strategy<Value = InverseInertia> {
    (0.7..1.0_f64, 0.3..1.0_f64).prop_map(|(linear, angular)| InverseInertia {
        linear,
        angular: angular / (RHO * RHO),
    })
}

/// Contacts between up to `boats` boats and the wall; `low` is the smallest bound.
fn scene(boats: u32, contacts: std::ops::Range<usize>, low: f64) -> impl Strategy<Value = Owned> {
    let one = (
        0..boats,
        0..=boats,
        -3.2..3.2_f64,
        -2.5..2.5_f64,
        -2.5..2.5_f64,
    )
        .prop_map(move |(i, j, angle, arm_i, arm_j)| {
            let second = (j < boats && j != i).then_some(j);
            contact(i, second, angle, (arm_i, arm_j))
        });
    let bound = prop_oneof![Just(0.0), low..5.0_f64];
    (
        prop::collection::vec((one, bound), contacts),
        prop::collection::vec((velocity(), inertia()), boats as usize),
    )
        .prop_map(|(contacts, boats)| {
            let (contacts, biases) = contacts.into_iter().unzip();
            let (free, inertia) = boats.into_iter().unzip();
            Owned {
                contacts,
                inertia,
                free,
                biases,
            }
        })
}

/// The scene with contacts repeated and opposed, or repeated and turned a little. Not both: a normal,
/// its opposite and one turned by 1e-9 leave a way out that no impulse below 1e9 cm/s finds.
fn worsened(mut scene: Owned, opposed: bool, picks: &[(usize, usize)]) -> Owned {
    for &(pick, how) in picks {
        let k = pick % scene.contacts.len();
        let mut copy = scene.contacts[k];
        if !opposed {
            let (sin, cos) = f64::sin_cos([0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1e-2][how % 6]);
            let n = copy.gap.normal;
            copy.gap.normal = Vec2::new(cos * n.x - sin * n.y, sin * n.x + cos * n.y);
        } else if how % 2 == 1 {
            // The wall on the other side: nothing may move along this normal.
            copy.gap.normal = -copy.gap.normal;
            copy.gap.arm_i = -copy.gap.arm_i;
            copy.gap.arm_j = -copy.gap.arm_j;
        }
        let bound = scene.biases[k];
        scene.contacts.push(copy);
        scene.biases.push(bound);
    }
    scene
}

/// Solves a problem in which rest meets every constraint, and compares with a reference where that
/// found its way.
fn compare(scene: &Owned, reference: Option<Reference>) -> Result<(), TestCaseError> {
    let (report, impulses, velocities) = scene.solve(Solver::BlockPivoting);
    prop_assert!(report.converged && report.residual <= 1e-10, "{report:?}");
    prop_assert!(impulses.iter().all(|&impulse| impulse >= 0.0));
    // The residual reported is the residual, but for the rounding of sums.
    let total: f64 = impulses.iter().sum();
    let dense = Dense::of(&scene.problem());
    let residual = dense.residual(&impulses);
    prop_assert!(
        (residual - report.residual).abs() < 1e-13 * (1e3 + total),
        "{residual:e}"
    );
    if let Some(expected) = reference {
        // Of two points that minimize ½|x|² for multipliers λ and λ', and violate the constraints by at most
        // ε and ε', the distance is at most |x − x'|² ≤ Σλ·ε' + Σλ'·ε. Nearly dependent constraints have
        // large multipliers.
        let x = Dense::scaled(&scene.problem(), &velocities);
        let violation = |x: &DVector<f64>| (&dense.g * x - &dense.h).min().min(0.0).abs() + 1e-12;
        let apart = total * violation(&expected.x) + expected.total * (violation(&x) + residual);
        let error = (&x - &expected.x).norm();
        let bound = 1e-9 * (1.0 + expected.x.norm()) + 2.0 * apart.sqrt();
        prop_assert!(error < bound, "{error:e} {bound:e}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn small_problems_agree_with_enumeration(scene in scene(4, 1..8, 0.0)) {
        let reference = Dense::of(&scene.problem()).by_enumeration(1e-9);
        compare(&scene, reference)?;
    }

    #[test]
    fn the_two_references_agree(scene in scene(4, 1..8, 0.0)) {
        let dense = Dense::of(&scene.problem());
        let (a, b) = (dense.by_enumeration(1e-9), dense.by_goldfarb_idnani(1e-10));
        // One in 1e5 draws is too nearly singular for one of them.
        if let (Some(a), Some(b)) = (a, b)
            && a.total + b.total < 1e4
        {
            prop_assert!((&a.x - &b.x).norm() < 1e-6 * (1.0 + a.x.norm()));
        }
    }

    #[test]
    fn larger_problems_agree_with_goldfarb_and_idnani(scene in scene(12, 10..40, 0.0)) {
        let reference = Dense::of(&scene.problem()).by_goldfarb_idnani(1e-10);
        compare(&scene, reference)?;
    }

    #[test]
    fn degenerate_problems_are_solved_too(
        scene in scene(6, 3..16, 0.0),
        opposed in any::<bool>(),
        picks in prop::collection::vec((0_usize..1000, 0_usize..10), 1..12),
    ) {
        let scene = worsened(scene, opposed, &picks);
        // Normals turned by as little as 1e-12 leave the motion open by more than rounding: the residual
        // has to do there.
        let reference = opposed.then(|| Dense::of(&scene.problem()).by_goldfarb_idnani(1e-10));
        let reference = reference.flatten();
        compare(&scene, reference)?;
    }

    #[test]
    fn overlaps_are_opened_or_their_contradiction_reported(scene in scene(5, 1..14, -2.0)) {
        let dense = Dense::of(&scene.problem());
        let (report, impulses, velocities) = scene.solve(Solver::BlockPivoting);
        prop_assert!(impulses.iter().all(|impulse| impulse.is_finite()));
        prop_assert!(velocities.iter().all(Velocity::is_finite));
        match dense.by_goldfarb_idnani(1e-9) {
            // Nearly contradicting constraints have solutions of any size, to rounding: moderate ones count.
            Some(expected) if expected.x.norm() < 1e3 && impulses.iter().sum::<f64>() < 1e4 => {
                prop_assert!(report.converged && report.residual <= 1e-10, "{report:?}");
            }
            _ => {}
        }
    }

    #[test]
    fn solving_again_is_solving(scene in scene(8, 5..25, 0.0), other in scene(8, 25..26, 0.0)) {
        // With new biases and velocities on the same contacts, the factor kept gives the same answer.
        let mut solver = ContactSolver::new(Solver::BlockPivoting).keeping_factors(true);
        solver.active = vec![false; scene.contacts.len()];
        solver.impulses = vec![0.0; scene.contacts.len()];
        solver.reset(8, &scene.contacts);
        solver.solve(&scene.problem());
        let changed = Owned {
            free: other.free.clone(),
            biases: other.biases[..scene.biases.len()].to_vec(),
            ..scene
        };
        let report = solver.solve(&changed.problem());
        prop_assert!(report.residual <= 1e-10);
        let (_, _, fresh) = changed.solve(Solver::BlockPivoting);
        for (a, b) in solver.velocities.iter().zip(&fresh) {
            prop_assert!((a.linear - b.linear).norm() + (a.angular - b.angular).abs() < 1e-7);
        }
    }
}
