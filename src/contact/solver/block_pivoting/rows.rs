//! The contact problem of one island: rows of J, and the boats that they join, numbered within the island.

use crate::contact::{ContactProblem, InverseInertia};
use crate::geometry::{Velocity, smaller};

/// Signs are judged with this tolerance in cm/s, well below [`EXACT`](crate::contact::solver::EXACT). A regularization
/// below this number counts as none.
pub(super) const TOLERANCE: f64 = 1e-11;

/// No row.
pub(super) const NONE: u32 = u32::MAX;
/// Index of the walls among an island's bodies. They are at rest, and no impulse moves them.
pub(super) const WALLS: u32 = 0;

/// Natural residual of a row in cm/s. `speed` is its impulse times A_kk. A regularized row may yield.
#[inline]
pub(super) fn residual(speed: f64, slack: f64, regularization: f64) -> f64 {
    let compliance = if regularization < TOLERANCE {
        0.0
    } else {
        regularization
    };
    smaller(speed, slack + compliance * speed).abs()
}

/// Two linear components and the angular one, of a row of J or of a velocity.
pub(super) type Components = [f64; 3];

/// One row of J and of J·M⁻¹, with its part of the solution. A contact with a wall has the walls as its
/// second body, so that all rows look alike.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    /// Its contact.
    pub contact: u32,
    /// Its bodies, by their index in the island.
    pub bodies: [u32; 2],
    /// Its row of J, for each body.
    pub jacobian: [Components; 2],
    /// Its row of J·M⁻¹, for each body.
    pub response: [Components; 2],
    /// A_kk.
    pub diagonal: f64,
    /// bias_k.
    pub bias: f64,
    /// b_k = J_k·v_free + bias_k.
    pub right: f64,
    /// λ_k.
    pub impulse: f64,
    /// w_k = J_k·v + bias_k.
    pub slack: f64,
    /// Whether the gap is to close exactly.
    pub is_active: bool,
}

/// A boat of an island.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Body {
    /// Its index in the flock; [`NONE`] for the walls.
    pub boat: u32,
    /// Its velocity without contacts.
    pub free: Components,
    /// Its velocity with contacts.
    pub velocity: Components,
}

#[inline]
fn dot(a: &Components, b: &Components) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn add(velocity: &mut Components, response: &Components, impulse: f64) {
    velocity[0] += response[0] * impulse;
    velocity[1] += response[1] * impulse;
    velocity[2] += response[2] * impulse;
}

impl Body {
    /// The walls, as a body at rest.
    fn walls() -> Self {
        Self {
            boat: NONE,
            ..Self::default()
        }
    }

    /// A boat with its velocity without contacts.
    pub(super) fn new(boat: u32, free: &Velocity) -> Self {
        Self {
            boat,
            free: [free.linear.x, free.linear.y, free.angular],
            velocity: Components::default(),
        }
    }
}

impl Row {
    /// Sets J and J·M⁻¹ on one side; returns that side's part of A_kk.
    #[inline]
    fn set_side(&mut self, side: usize, jacobian: Components, inertia: &InverseInertia) -> f64 {
        let [x, y, arm] = jacobian;
        let response = [
            x * inertia.linear,
            y * inertia.linear,
            arm * inertia.angular,
        ];
        (self.jacobian[side], self.response[side]) = (jacobian, response);
        dot(&jacobian, &response)
    }

    /// A_kl of two rows through a body on these sides of them.
    #[inline]
    pub(super) fn coupling(&self, side: usize, other: &Self, other_side: usize) -> f64 {
        dot(&self.response[side], &other.jacobian[other_side])
    }

    /// Applies an impulse at the row to the velocities.
    #[inline]
    fn push(&self, impulse: f64, bodies: &mut [Body]) {
        let (first, second) = (self.bodies[0] as usize, self.bodies[1] as usize);
        add(&mut bodies[first].velocity, &self.response[0], impulse);
        add(&mut bodies[second].velocity, &self.response[1], impulse);
    }

    /// Whether the contact pulls, or overlaps without carrying an impulse.
    #[inline]
    pub(super) fn is_violated(&self) -> bool {
        let value = if self.is_active {
            self.impulse * self.diagonal
        } else {
            self.slack
        };
        value < -TOLERANCE
    }

    /// w_k = J_k·v + bias_k.
    #[inline]
    pub(super) fn slack(&self, bodies: &[Body]) -> f64 {
        dot(&self.jacobian[0], &bodies[self.bodies[0] as usize].velocity)
            + dot(&self.jacobian[1], &bodies[self.bodies[1] as usize].velocity)
            + self.bias
    }
}

/// The rows and bodies of one island.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    pub rows: Vec<Row>,
    pub bodies: Vec<Body>,
}

impl Rows {
    /// Lays out the rows of some contacts. `indices` is scratch space, [`NONE`] for every boat.
    pub(super) fn build(
        &mut self,
        problem: &ContactProblem,
        contacts: &[u32],
        indices: &mut [u32],
    ) {
        self.bodies.clear();
        self.bodies.push(Body::walls());
        self.rows.resize(contacts.len(), Row::default());
        for (number, &k) in contacts.iter().enumerate() {
            let contact = &problem.contacts[k as usize];
            let first_body = self.body(contact.boat, problem, indices);
            // The walls have no inertia: their side takes the boat's, and a row of J of zeros.
            let (sign, second) = match contact.second() {
                Some(second) => (-1.0, second),
                None => (0.0, contact.boat as usize),
            };
            let second_body = self.body(second as u32, problem, indices);
            let row = &mut self.rows[number];
            row.contact = k;
            row.bodies = [first_body, if sign == 0.0 { WALLS } else { second_body }];
            let (normal, inertia) = (contact.gap.normal, problem.inertia);
            let first_jacobian = [normal.x, normal.y, contact.gap.arm_i];
            let second_jacobian =
                [normal.x, normal.y, contact.gap.arm_j].map(|number| sign * number);
            row.diagonal = row.set_side(0, first_jacobian, &inertia[contact.boat as usize])
                + row.set_side(1, second_jacobian, &inertia[second]);
        }
        for body in &self.bodies[1..] {
            indices[body.boat as usize] = NONE;
        }
    }

    /// Index of a boat in the island. A boat that is not yet in the island is added.
    fn body(&mut self, boat: u32, problem: &ContactProblem, indices: &mut [u32]) -> u32 {
        let index = &mut indices[boat as usize];
        if *index == NONE {
            *index = self.bodies.len() as u32;
            let free = &problem.free[boat as usize];
            self.bodies.push(Body::new(boat, free));
        }
        *index
    }

    /// Guesses the active rows: those that push after sweeps of projected Gauss–Seidel from the present impulses. Most
    /// changes in a substep are local, so that two sweeps find them.
    pub(super) fn sweep(&mut self, sweeps: u32) {
        self.set_velocities();
        let Self { rows, bodies } = self;
        for _ in 0..sweeps {
            for row in rows.iter_mut() {
                // Only the division can run while the previous row is computed. `f64::max` would take longer than this
                // comparison.
                let inverse = 1.0 / row.diagonal;
                let (full, least) = (-row.slack(bodies) * inverse, -row.impulse);
                let change = if full > least { full } else { least };
                row.push(change, bodies);
                row.impulse += change;
                row.is_active = row.impulse > 0.0;
            }
        }
    }

    /// Sets velocities to those that the impulses give.
    #[inline(always)]
    fn set_velocities(&mut self) {
        for body in &mut self.bodies {
            body.velocity = body.free;
        }
        for row in &self.rows {
            row.push(row.impulse, &mut self.bodies);
        }
    }

    /// Recomputes velocities and slacks from the impulses. Returns the number of rows with a wrong sign, and the largest
    /// absolute slack of an active row.
    pub(super) fn update(&mut self) -> (usize, f64) {
        self.set_velocities();
        let (mut violations, mut worst) = (0, 0.0_f64);
        for row in &mut self.rows {
            row.slack = row.slack(&self.bodies);
            if row.is_active && row.slack.abs() > worst {
                worst = row.slack.abs();
            }
            violations += usize::from(row.is_violated());
        }
        (violations, worst)
    }
}
