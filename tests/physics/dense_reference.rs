//! Independent dense solutions of a contact problem, slow and plain: enumeration of active sets, and
//! the dual active-set method of Goldfarb and Idnani (1983) with pseudo-inverses.
//!
//! With x = M^½·(v − v_free) the problem is min ½|x|² subject to G·x ≥ h, where G = J·M^−½ and
//! h = −(J·v_free + bound).

use flockenv::contact::ContactProblem;
use flockenv::geometry::Velocity;
use nalgebra::{DMatrix, DVector};

/// The problem in scaled coordinates.
pub struct Dense {
    pub g: DMatrix<f64>,
    pub h: DVector<f64>,
}

/// A solution and the sum of its multipliers.
pub struct Reference {
    pub x: DVector<f64>,
    pub total: f64,
}

impl Dense {
    pub fn of(problem: &ContactProblem) -> Self {
        let (rows, columns) = (problem.contacts.len(), 3 * problem.free.len());
        let mut g = DMatrix::zeros(rows, columns);
        let mut h = DVector::zeros(rows);
        for (k, contact) in problem.contacts.iter().enumerate() {
            let sides = [
                (Some(contact.boat as usize), 1.0, contact.gap.arm_i),
                (contact.second(), -1.0, contact.gap.arm_j),
            ];
            let mut rate = 0.0;
            for (boat, sign, arm) in sides {
                let Some(boat) = boat else { continue };
                let row = [contact.gap.normal.x, contact.gap.normal.y, arm].map(|x| sign * x);
                let free = &problem.free[boat];
                rate += row[0] * free.linear.x + row[1] * free.linear.y + row[2] * free.angular;
                let weight = &problem.inertia[boat];
                let roots = [weight.linear, weight.linear, weight.angular].map(f64::sqrt);
                for axis in 0..3 {
                    g[(k, 3 * boat + axis)] += row[axis] * roots[axis];
                }
            }
            h[k] = -(rate + problem.biases[k]);
        }
        Self { g, h }
    }

    /// x of given velocities.
    pub fn scaled(problem: &ContactProblem, velocities: &[Velocity]) -> DVector<f64> {
        let mut x = DVector::zeros(3 * velocities.len());
        for (boat, (v, free)) in velocities.iter().zip(problem.free).enumerate() {
            let weight = &problem.inertia[boat];
            x[3 * boat] = (v.linear.x - free.linear.x) / weight.linear.sqrt();
            x[3 * boat + 1] = (v.linear.y - free.linear.y) / weight.linear.sqrt();
            x[3 * boat + 2] = (v.angular - free.angular) / weight.angular.sqrt();
        }
        x
    }

    /// Natural residual of impulses, straight from the matrices.
    pub fn residual(&self, impulses: &[f64]) -> f64 {
        let lambda = DVector::from_column_slice(impulses);
        let w = &self.g * (self.g.transpose() * &lambda) - &self.h;
        (0..w.len())
            .map(|k| (self.g.row(k).norm_squared() * lambda[k]).min(w[k]).abs())
            .fold(0.0, f64::max)
    }

    fn rows(&self, set: &[usize]) -> DMatrix<f64> {
        self.g.select_rows(set)
    }

    /// The constraints of a set as equations for x.
    fn equalities(&self, set: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let right = DVector::from_iterator(set.len(), set.iter().map(|&k| self.h[k]));
        (self.rows(set), right)
    }

    /// The solution by trying every active set; `None` if none fits. Tolerances grow with the
    /// multipliers, which nearly dependent constraints make large.
    pub fn by_enumeration(&self, tolerance: f64) -> Option<Reference> {
        let contacts = self.h.len();
        assert!(contacts <= 10, "2^contacts sets");
        (0_u32..1 << contacts).find_map(|bits| {
            let set: Vec<usize> = (0..contacts).filter(|k| bits >> k & 1 == 1).collect();
            if set.is_empty() {
                let x = DVector::zeros(self.g.ncols());
                return (self.h.max() <= tolerance).then_some(Reference { x, total: 0.0 });
            }
            let (rows, right) = self.equalities(&set);
            let x = solve_least_norm(&rows, &right, 1e-13);
            let lambda = solve_least_norm(&rows.transpose(), &x, 1e-13);
            let slack = tolerance * (1.0 + lambda.amax());
            let fits = lambda.min() >= -slack && (&self.g * &x - &self.h).min() >= -slack;
            fits.then(|| Reference {
                x,
                total: lambda.sum(),
            })
        })
    }

    /// The solution by Goldfarb and Idnani; `None` if the constraints contradict each other.
    pub fn by_goldfarb_idnani(&self, tolerance: f64) -> Option<Reference> {
        let mut x = DVector::zeros(self.g.ncols());
        let (mut set, mut u): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
        for _ in 0..10_000 {
            let slack = &self.g * &x - &self.h;
            let worst = slack.imin();
            if slack[worst] >= -tolerance {
                return Some(self.polished(&set, x));
            }
            if !self.add_constraint(worst, &mut x, &mut set, &mut u) {
                return None;
            }
        }
        panic!("the dual method ends after finitely many constraints");
    }

    /// The least x that meets a set's constraints as equalities: `x` without the rounding of its way.
    pub fn polished(&self, set: &[usize], x: DVector<f64>) -> Reference {
        if set.is_empty() {
            return Reference { x, total: 0.0 };
        }
        let (rows, right) = self.equalities(set);
        let x = solve_least_norm(&rows, &right, 1e-13);
        let lambda = solve_least_norm(&rows.transpose(), &x, 1e-13);
        Reference {
            x,
            total: lambda.sum(),
        }
    }

    /// Moves until one violated constraint is met, dropping others whose multipliers vanish.
    fn add_constraint(
        &self,
        p: usize,
        x: &mut DVector<f64>,
        set: &mut Vec<usize>,
        u: &mut Vec<f64>,
    ) -> bool {
        let normal = self.g.row(p).transpose();
        let mut own = 0.0;
        loop {
            // r = N⁺·n, z = n − N·r: the part of n along the set and across it.
            let n_t = self.rows(set);
            let r = if set.is_empty() {
                DVector::zeros(0)
            } else {
                solve_least_norm(&n_t.transpose(), &normal, 1e-13)
            };
            let z = &normal - n_t.transpose() * &r;
            let across = z.norm_squared();
            let dependent = across <= 1e-22 * normal.norm_squared();
            let full = if dependent {
                f64::INFINITY
            } else {
                (self.h[p] - normal.dot(x)) / across
            };
            let blocking = (0..set.len())
                .filter(|&j| r[j] > 1e-13)
                .map(|j| (u[j] / r[j], j))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let partial = blocking.map_or(f64::INFINITY, |(t, _)| t);
            let t = full.min(partial);
            if t.is_infinite() {
                return false;
            }
            u.iter_mut().zip(r.iter()).for_each(|(u, r)| *u -= t * r);
            own += t;
            if !dependent {
                *x += &z * t;
            }
            match blocking {
                Some((_, j)) if partial <= full => {
                    set.remove(j);
                    u.remove(j);
                }
                _ => {
                    set.push(p);
                    u.push(own);
                    return true;
                }
            }
        }
    }
}

fn solve_least_norm(matrix: &DMatrix<f64>, right: &DVector<f64>, cut: f64) -> DVector<f64> {
    let svd = matrix.clone().svd(true, true);
    let largest = svd.singular_values.max();
    svd.solve(right, cut * largest)
        .expect("both factors were computed")
}
