//! The contact matrix A = J·M⁻¹·Jᵀ, laid out island by island: what block pivoting works on.

use crate::boat::Velocity;
use crate::contact::{ContactProblem, Islands};
use crate::geometry::Vec2;
use std::ops::Range;

const NONE: u32 = u32::MAX;

/// One row of J and of J·M⁻¹. A wall is body number n, at rest and immovable, so that all rows look
/// alike.
#[derive(Debug, Clone, Copy)]
struct Row {
    bodies: [u32; 2],
    normal: Vec2,
    arms: [f64; 2],
    /// Inverse mass of each body, and arm over its moment of inertia.
    linear: [f64; 2],
    angular: [f64; 2],
}

/// A in rows of couplings to earlier contacts, with the right-hand side b.
#[derive(Debug, Clone, Default)]
pub struct ContactMatrix {
    /// The contact that each row belongs to.
    contacts: Vec<u32>,
    rows: Vec<Row>,
    diagonal: Vec<f64>,
    /// b = J·v_free + bound.
    right: Vec<f64>,
    starts: Vec<u32>,
    couplings: Vec<(u32, f64)>,
    /// The last row on each body so far, and for each row the one before it on either body.
    last: Vec<u32>,
    before: Vec<[u32; 2]>,
}

impl ContactMatrix {
    /// Lays out A for the contacts of a problem.
    pub fn build(&mut self, problem: &ContactProblem, islands: &Islands) {
        let bodies = problem.free.len();
        self.contacts.clear();
        self.rows.clear();
        self.diagonal.clear();
        self.couplings.clear();
        self.before.clear();
        self.starts.clear();
        self.starts.push(0);
        self.last.clear();
        self.last.resize(bodies + 1, NONE);
        for island in 0..islands.len() {
            for &k in islands.contacts(island) {
                self.push(problem, k, bodies);
            }
        }
    }

    fn push(&mut self, problem: &ContactProblem, k: u32, wall: usize) {
        let contact = &problem.contacts[k as usize];
        let gap = &contact.gap;
        let (first, second) = (contact.boat as usize, contact.second());
        let inertia = [Some(first), second].map(|body| body.map(|body| problem.inertia[body]));
        let arms = [gap.arm_i, gap.arm_j];
        let linear = inertia.map(|inertia| inertia.map_or(0.0, |inertia| inertia.linear));
        let angular = [0, 1].map(|side| inertia[side].map_or(0.0, |i| i.angular * arms[side]));
        let row = Row {
            bodies: [first as u32, second.unwrap_or(wall) as u32],
            normal: gap.normal,
            arms,
            linear,
            angular,
        };
        let number = self.rows.len() as u32;
        let mut before = [NONE; 2];
        let sides = if second.is_some() { 2 } else { 1 };
        for (side, before) in before.iter_mut().enumerate().take(sides) {
            *before = std::mem::replace(&mut self.last[row.bodies[side] as usize], number);
            self.couple(&row, side, *before);
        }
        self.diagonal
            .push(linear[0] + linear[1] + arms[0] * angular[0] + arms[1] * angular[1]);
        self.contacts.push(k);
        self.rows.push(row);
        self.before.push(before);
        self.starts.push(self.couplings.len() as u32);
    }

    /// Couplings of a new row through one of its bodies, to the rows from `last` back.
    fn couple(&mut self, row: &Row, side: usize, mut last: u32) {
        let body = row.bodies[side];
        while let Some(other) = self.rows.get(last as usize) {
            let other_side = usize::from(other.bodies[0] != body);
            let coupling = row.normal.dot(&other.normal) * row.linear[side]
                + row.angular[side] * other.arms[other_side];
            let signed = if side == other_side {
                coupling
            } else {
                -coupling
            };
            self.couplings.push((last, signed));
            last = self.before[last as usize][other_side];
        }
    }

    /// Works out b for free velocities and bounds.
    pub fn set_right(&mut self, problem: &ContactProblem) {
        self.right.clear();
        let slacks = self
            .contacts
            .iter()
            .map(|&k| problem.slack(k as usize, problem.free));
        self.right.extend(slacks);
    }

    /// The contact that a row belongs to.
    pub fn contact(&self, row: usize) -> usize {
        self.contacts[row] as usize
    }

    /// A_kk of every row.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// b of every row.
    pub fn right(&self) -> &[f64] {
        &self.right
    }

    /// Off-diagonal entries to earlier rows, one for every shared body.
    pub fn couplings(&self, row: usize) -> &[(u32, f64)] {
        &self.couplings[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// Velocities, the wall's last, that impulses give to the bodies of a range of rows.
    pub fn move_bodies(
        &self,
        rows: Range<usize>,
        impulses: &[f64],
        free: &[Velocity],
        velocities: &mut [Velocity],
    ) {
        for row in &self.rows[rows.clone()] {
            for body in row.bodies {
                if let Some(velocity) = free.get(body as usize) {
                    velocities[body as usize] = *velocity;
                }
            }
        }
        for (row, &impulse) in self.rows[rows.clone()].iter().zip(&impulses[rows]) {
            if impulse != 0.0 {
                let first = &mut velocities[row.bodies[0] as usize];
                first.linear += row.normal * (impulse * row.linear[0]);
                first.angular += impulse * row.angular[0];
                let second = &mut velocities[row.bodies[1] as usize];
                second.linear -= row.normal * (impulse * row.linear[1]);
                second.angular -= impulse * row.angular[1];
            }
        }
    }

    /// w = A·λ + b of a range of rows, through velocities and their free counterparts.
    pub fn slacks(
        &self,
        rows: Range<usize>,
        problem: &ContactProblem,
        velocities: &[Velocity],
        slacks: &mut [f64],
    ) {
        let contacts = &self.contacts[rows.clone()];
        for ((row, slack), &k) in self.rows[rows.clone()]
            .iter()
            .zip(&mut slacks[rows])
            .zip(contacts)
        {
            let first = &velocities[row.bodies[0] as usize];
            let second = &velocities[row.bodies[1] as usize];
            *slack = row.normal.dot(&(first.linear - second.linear)) + row.arms[0] * first.angular
                - row.arms[1] * second.angular
                + problem.bounds[k as usize];
        }
    }
}
