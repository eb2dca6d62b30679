//! The contact problem of one island in numbers of its own: rows of J, and the boats they join.

use crate::contact::{Contact, ContactProblem};

/// Signs are judged with this tolerance in cm/s, well below [`EXACT`](crate::contact::solver::EXACT).
pub const TOLERANCE: f64 = 1e-11;

/// No row.
pub const NONE: u32 = u32::MAX;
/// The place of the walls among an island's bodies: at rest, and nothing moves them.
pub const WALLS: u32 = 0;

/// Linear and angular parts of a row of J, or of a velocity.
pub type Motion = [f64; 3];

/// One row of J and of J·M⁻¹, with its part of the solution. A contact with a wall has the walls as its
/// second body, so that all rows look alike.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The contact it belongs to.
    pub contact: u32,
    /// Its bodies, by their place in the island.
    pub bodies: [u32; 2],
    /// The row before on either body, times two, plus the side on which that row has it.
    pub before: [u32; 2],
    /// J, and J·M⁻¹.
    pub jacobian: [Motion; 2],
    pub response: [Motion; 2],
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
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// Its number in the flock; none for the walls.
    pub boat: u32,
    /// The last row on it so far, as in [`Row::before`].
    pub last: u32,
    /// Its velocity without contacts, and with.
    pub free: Motion,
    pub velocity: Motion,
}

#[inline]
fn dot(a: &Motion, b: &Motion) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn add(velocity: &mut Motion, response: &Motion, impulse: f64) {
    velocity[0] += response[0] * impulse;
    velocity[1] += response[1] * impulse;
    velocity[2] += response[2] * impulse;
}

impl Body {
    const WALLS: Self = Self {
        boat: NONE,
        last: NONE,
        free: [0.0; 3],
        velocity: [0.0; 3],
    };
}

impl Row {
    /// A_kl of two rows through a body that is on these sides of them.
    #[inline]
    pub fn coupling(&self, side: usize, other: &Self, other_side: usize) -> f64 {
        dot(&self.response[side], &other.jacobian[other_side])
    }

    /// Changes velocities by the row's impulse.
    #[inline]
    pub fn push(&self, bodies: &mut [Body]) {
        add(
            &mut bodies[self.bodies[0] as usize].velocity,
            &self.response[0],
            self.impulse,
        );
        add(
            &mut bodies[self.bodies[1] as usize].velocity,
            &self.response[1],
            self.impulse,
        );
    }

    /// Whether the contact pulls, or overlaps although it carries nothing.
    #[inline]
    pub fn is_violated(&self) -> bool {
        let value = if self.is_active {
            self.impulse * self.diagonal
        } else {
            self.slack
        };
        value < -TOLERANCE
    }

    /// w_k = J_k·v + bias_k.
    #[inline]
    pub fn slack(&self, bodies: &[Body]) -> f64 {
        dot(&self.jacobian[0], &bodies[self.bodies[0] as usize].velocity)
            + dot(&self.jacobian[1], &bodies[self.bodies[1] as usize].velocity)
            + self.bias
    }
}

/// The rows and bodies of one island.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    pub rows: Vec<Row>,
    pub bodies: Vec<Body>,
}

impl Rows {
    /// Lays out the rows of some contacts. `places` maps boats to bodies, [`NONE`] for boats not met yet.
    pub fn build(&mut self, problem: &ContactProblem, contacts: &[u32], places: &mut [u32]) {
        self.rows.clear();
        self.bodies.clear();
        self.bodies.push(Body::WALLS);
        for &k in contacts {
            self.push(problem, k, places);
        }
    }

    fn push(&mut self, problem: &ContactProblem, k: u32, places: &mut [u32]) {
        let contact: &Contact = &problem.contacts[k as usize];
        let gap = &contact.gap;
        let number = 2 * self.rows.len() as u32;
        let (first, before) = self.body(contact.boat, number, places);
        let inertia = &problem.inertia[contact.boat as usize];
        let jacobian = [gap.normal.x, gap.normal.y, gap.arm_i];
        let response = [
            jacobian[0] * inertia.linear,
            jacobian[1] * inertia.linear,
            jacobian[2] * inertia.angular,
        ];
        let mut row = Row {
            contact: k,
            bodies: [first, WALLS],
            before: [before, NONE],
            jacobian: [jacobian, [0.0; 3]],
            response: [response, [0.0; 3]],
            diagonal: dot(&jacobian, &response),
            bias: 0.0,
            right: 0.0,
            impulse: 0.0,
            slack: 0.0,
            is_active: false,
        };
        if let Some(second) = contact.second() {
            let (place, before) = self.body(second as u32, number + 1, places);
            let inertia = &problem.inertia[second];
            let jacobian = [-gap.normal.x, -gap.normal.y, -gap.arm_j];
            let response = [
                jacobian[0] * inertia.linear,
                jacobian[1] * inertia.linear,
                jacobian[2] * inertia.angular,
            ];
            row.bodies[1] = place;
            row.before[1] = before;
            row.jacobian[1] = jacobian;
            row.response[1] = response;
            row.diagonal += dot(&jacobian, &response);
        }
        self.rows.push(row);
    }

    /// The place of a boat, and the row that was the last one on it before `row`.
    fn body(&mut self, boat: u32, row: u32, places: &mut [u32]) -> (u32, u32) {
        let place = &mut places[boat as usize];
        if *place == NONE {
            *place = self.bodies.len() as u32;
            self.bodies.push(Body {
                boat,
                last: row,
                ..Body::WALLS
            });
            return (*place, NONE);
        }
        let last = &mut self.bodies[*place as usize].last;
        (*place, std::mem::replace(last, row))
    }

    /// Brings velocities and slacks up to date with the impulses; returns how many signs are wrong, and the
    /// largest slack of an active row.
    pub fn update(&mut self) -> (usize, f64) {
        for body in &mut self.bodies {
            body.velocity = body.free;
        }
        for row in &self.rows {
            if row.impulse != 0.0 {
                row.push(&mut self.bodies);
            }
        }
        let (mut violations, mut worst) = (0, 0.0_f64);
        for row in &mut self.rows {
            row.slack = row.slack(&self.bodies);
            if row.is_active {
                worst = worst.max(row.slack.abs());
            }
            violations += usize::from(row.is_violated());
        }
        (violations, worst)
    }
}
