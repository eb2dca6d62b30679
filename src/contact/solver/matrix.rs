//! The contact matrix A = J·M⁻¹·Jᵀ, laid out island by island: what block pivoting works on.

use crate::contact::{ContactProblem, Islands};
use crate::geometry::{Vec2, Velocity};

const NONE: u32 = u32::MAX;

/// One row of J, of J·M⁻¹ and of A. A wall is body number n, at rest and immovable, so that all rows
/// look alike.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The contact it belongs to.
    pub contact: u32,
    bodies: [u32; 2],
    normal: Vec2,
    arms: [f64; 2],
    /// Inverse mass of each body, and arm over its moment of inertia.
    linear: [f64; 2],
    angular: [f64; 2],
    /// A_kk.
    pub diagonal: f64,
    /// b_k = J_k·v_free + bound_k.
    pub right: f64,
    /// bound_k.
    bound: f64,
    /// The row before on either body.
    before: [u32; 2],
    /// Where its couplings begin and end.
    couplings: [u32; 2],
}

/// A in rows of couplings to earlier rows, with the right-hand side b.
#[derive(Debug, Clone, Default)]
pub struct ContactMatrix {
    rows: Vec<Row>,
    couplings: Vec<(u32, f64)>,
    /// The last row on each body so far.
    last: Vec<u32>,
}

impl ContactMatrix {
    /// Lays out A for the contacts of a problem.
    pub fn build(&mut self, problem: &ContactProblem, islands: &Islands) {
        self.rows.clear();
        self.couplings.clear();
        self.last.clear();
        self.last.resize(problem.free.len(), NONE);
        for &k in islands.all_contacts() {
            self.push(problem, k);
        }
    }

    fn push(&mut self, problem: &ContactProblem, k: u32) {
        let contact = &problem.contacts[k as usize];
        let gap = &contact.gap;
        let first = contact.boat as usize;
        let own = &problem.inertia[first];
        let number = self.rows.len() as u32;
        let begin = self.couplings.len() as u32;
        let mut row = Row {
            contact: k,
            bodies: [contact.boat, problem.free.len() as u32],
            normal: gap.normal,
            arms: [gap.arm_i, 0.0],
            linear: [own.linear, 0.0],
            angular: [own.angular * gap.arm_i, 0.0],
            diagonal: own.linear + own.angular * gap.arm_i * gap.arm_i,
            right: 0.0,
            bound: 0.0,
            before: [std::mem::replace(&mut self.last[first], number), NONE],
            couplings: [begin; 2],
        };
        self.couple(&row, 0);
        if let Some(second) = contact.second() {
            let other = &problem.inertia[second];
            row.bodies[1] = second as u32;
            row.arms[1] = gap.arm_j;
            row.linear[1] = other.linear;
            row.angular[1] = other.angular * gap.arm_j;
            row.diagonal += other.linear + other.angular * gap.arm_j * gap.arm_j;
            row.before[1] = std::mem::replace(&mut self.last[second], number);
            self.couple(&row, 1);
        }
        row.couplings[1] = self.couplings.len() as u32;
        self.rows.push(row);
    }

    /// Couplings of a new row to earlier ones, through one of its bodies.
    fn couple(&mut self, row: &Row, side: usize) {
        let body = row.bodies[side];
        let mut last = row.before[side];
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
            last = other.before[other_side];
        }
    }

    /// Takes on bounds and works out b.
    pub fn set_right(&mut self, problem: &ContactProblem, free: &[Velocity]) {
        for row in &mut self.rows {
            row.bound = problem.biases[row.contact as usize];
            row.right = row.slack(free);
        }
    }

    /// All rows, island by island.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Off-diagonal entries to earlier rows, one for every shared body.
    pub fn couplings(&self, row: usize) -> &[(u32, f64)] {
        let [begin, end] = self.rows[row].couplings;
        &self.couplings[begin as usize..end as usize]
    }
}

impl Row {
    /// w_k = J_k·v + bound_k for velocities of all boats and, last, of the walls.
    #[inline]
    pub fn slack(&self, velocities: &[Velocity]) -> f64 {
        let [first, second] = self.bodies.map(|body| &velocities[body as usize]);
        self.normal.dot(&(first.linear - second.linear)) + self.arms[0] * first.angular
            - self.arms[1] * second.angular
            + self.bound
    }

    /// Gives the row's bodies their free velocities back.
    #[inline]
    pub fn release(&self, free: &[Velocity], velocities: &mut [Velocity]) {
        for body in self.bodies {
            velocities[body as usize] = free[body as usize];
        }
    }

    /// Changes velocities by an impulse.
    #[inline]
    pub fn apply(&self, impulse: f64, velocities: &mut [Velocity]) {
        let [first, second] = self.bodies;
        let velocity = &mut velocities[first as usize];
        velocity.linear += self.normal * (impulse * self.linear[0]);
        velocity.angular += impulse * self.angular[0];
        let velocity = &mut velocities[second as usize];
        velocity.linear -= self.normal * (impulse * self.linear[1]);
        velocity.angular -= impulse * self.angular[1];
    }
}
