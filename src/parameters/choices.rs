//! The choices that users make by name.

use super::named_choice;

named_choice! {
    /// The tangential direction that leaders steer to and rewards are measured in.
    pub enum Target ("target") {
        /// Clockwise seen from above: LAP orientation +π/2.
        Clockwise = "cw",
        /// Counter-clockwise: LAP orientation −π/2.
        CounterClockwise = "ccw",
    }
}

impl Target {
    /// The other direction.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Clockwise => Self::CounterClockwise,
            Self::CounterClockwise => Self::Clockwise,
        }
    }

    /// +1 for clockwise, −1 for counter-clockwise: the sign of the LAP orientation.
    pub fn sign(self) -> f64 {
        match self {
            Self::Clockwise => 1.0,
            Self::CounterClockwise => -1.0,
        }
    }
}

named_choice! {
    /// Time integrator of a substep.
    pub enum Scheme ("scheme") {
        /// Velocities at half steps and Crank–Nicolson: second order while contacts persist.
        Leapfrog = "leapfrog",
        /// Semi-implicit Euler with the same quadratic program: first order, for comparison.
        Moreau = "moreau",
        /// Steps 1–6 of the paper's appendix, taken literally.
        Paper = "paper",
    }
}

impl Scheme {
    /// The longest substep at which the scheme is stable, in s.
    pub fn longest_dt_s(self) -> f64 {
        match self {
            Self::Leapfrog => 1.0,
            Self::Moreau | Self::Paper => 0.1,
        }
    }
}

named_choice! {
    /// Meaning of η in eq. (9).
    pub enum Noise ("noise_scheme") {
        /// A stochastic differential equation: increment c4·sqrt(dt)·N(0, 1), c4 in rad/s^1.5.
        White = "white",
        /// The literal reading: increment c4·dt·N(0, 1), c4 in rad/s². Statistics depend on dt.
        PerStep = "per-step",
    }
}

named_choice! {
    /// Solver of the contact problem of a substep.
    pub enum Solver ("solver") {
        /// Exact: block principal pivoting on a Cholesky factor, island by island.
        BlockPivoting = "block-pivoting",
        /// Projected Gauss–Seidel, for comparison.
        GaussSeidel = "gauss-seidel",
        /// The interior-point solver clarabel, for comparison (residual 1e-4…1e-7 cm/s).
        Clarabel = "clarabel" if "clarabel",
    }
}
