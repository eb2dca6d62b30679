//! An engine with its settings and its step.

use crate::engines::{Box2d, Controlled, Ours, rapier_f32, rapier_f64};
use crate::table::{number, text};
use crate::{Engine, Start};
use flockenv::FlockParameters;
use flockenv::parameters::{Scheme, Solver};

/// An engine with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// flockenv.
    Ours {
        /// Time integrator.
        scheme: Scheme,
        /// Solver of contacts.
        solver: Solver,
        /// Deepest overlap in cm that a step may leave.
        tolerance_cm: f64,
    },
    /// flockenv with the default scheme and a step that follows its error.
    Controlled {
        /// Accepted difference in cm between a step and its two halves.
        accepted_cm: f64,
    },
    /// rapier2d-f64.
    RapierF64(rapier_f64::Settings),
    /// rapier2d, single precision.
    RapierF32(rapier_f32::Settings),
    /// Box2D.
    Box2d {
        /// Substeps of a step.
        substeps: i32,
        /// Threads of its own scheduler.
        workers: i32,
    },
}

/// An engine with its settings and its step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration {
    /// Engine and settings.
    pub kind: Kind,
    /// Step in s.
    pub dt_s: f64,
}

/// Steps in s at which engines are compared.
pub const STEPS_S: [f64; 5] = [0.005, 0.01, 0.02, 0.05, 0.1];
/// Tolerances in cm at which engines are compared, from gaps that are linearized once to the finest.
pub const TOLERANCES_CM: [f64; 4] = [f64::INFINITY, 1e-4, 1e-6, 1e-9];
/// The tolerance in cm of steps that follow their error.
pub const CONTROLLED_CM: f64 = 1e-6;
/// The longest step in s.
pub const LONGEST_S: f64 = 0.1;
/// The step in s of the main comparison.
pub const STEP_S: f64 = 0.01;

impl Configuration {
    /// Columns of the cells of [`Self::cells`].
    pub const COLUMNS: [&str; 6] = [
        "engine",
        "setting",
        "scheme",
        "solver",
        "tolerance_cm",
        "dt_s",
    ];

    /// flockenv with the exact solver.
    pub fn exact(scheme: Scheme, tolerance_cm: f64, dt_s: f64) -> Self {
        Self::ours(scheme, Solver::BlockPivoting, tolerance_cm, dt_s)
    }

    /// flockenv.
    pub fn ours(scheme: Scheme, solver: Solver, tolerance_cm: f64, dt_s: f64) -> Self {
        let kind = Kind::Ours {
            scheme,
            solver,
            tolerance_cm,
        };
        Self { kind, dt_s }
    }

    /// flockenv with a step that follows its error.
    pub fn controlled(accepted_cm: f64) -> Self {
        Self {
            kind: Kind::Controlled { accepted_cm },
            dt_s: LONGEST_S,
        }
    }

    /// rapier2d-f64 at its default accuracy, to which all ratios refer.
    pub fn rapier(dt_s: f64) -> Self {
        Self {
            kind: Kind::RapierF64(rapier_f64::Settings::default()),
            dt_s,
        }
    }

    /// Box2D with the number of substeps that its documentation advises.
    pub fn box2d(dt_s: f64) -> Self {
        Self {
            kind: Kind::Box2d {
                substeps: 4,
                workers: 1,
            },
            dt_s,
        }
    }

    /// The same with two threads.
    pub fn box2d_with_two_workers(dt_s: f64) -> Self {
        Self {
            kind: Kind::Box2d {
                substeps: 4,
                workers: 2,
            },
            dt_s,
        }
    }

    /// Every scheme × step × tolerance with the exact solver.
    pub fn all_exact() -> Vec<Self> {
        let mut all = Vec::new();
        for &scheme in Scheme::ALL {
            for tolerance_cm in TOLERANCES_CM {
                for dt_s in STEPS_S {
                    all.push(Self::exact(scheme, tolerance_cm, dt_s));
                }
            }
        }
        all
    }

    /// All configurations: exact, inexact, peers.
    pub fn all() -> Vec<Self> {
        [Self::all_exact(), Self::all_inexact(), Self::all_peers()].concat()
    }

    /// The other solvers, at the step of the main comparison.
    pub fn all_inexact() -> Vec<Self> {
        let solvers = [Solver::GaussSeidel, Solver::Clarabel];
        let with_solvers =
            |scheme| solvers.map(|solver| Self::ours(scheme, solver, f64::INFINITY, STEP_S));
        Scheme::ALL.iter().copied().flat_map(with_solvers).collect()
    }

    /// The peers in this binary: steps at default settings, then settings at the step of the main comparison.
    pub fn all_peers() -> Vec<Self> {
        let mut all: Vec<Self> = [0.005, 0.01, 0.02].map(Self::rapier).to_vec();
        let defaults = rapier_f64::Settings::default();
        let settings = [
            rapier_f64::Settings {
                iterations: 8,
                ..defaults
            },
            rapier_f64::Settings {
                iterations: 16,
                ..defaults
            },
            rapier_f64::Settings {
                length_unit_cm: 1.0,
                ..defaults
            },
            rapier_f64::Settings {
                length_unit_cm: 100.0,
                ..defaults
            },
            rapier_f64::Settings {
                round_obstacle: true,
                ..defaults
            },
        ];
        all.extend(settings.map(|set| Self {
            kind: Kind::RapierF64(set),
            dt_s: STEP_S,
        }));
        let single = Kind::RapierF32(rapier_f32::Settings::default());
        all.push(Self {
            kind: single,
            dt_s: STEP_S,
        });
        all.extend([0.005, 0.01, 0.02].map(Self::box2d));
        all.push(Self {
            kind: Kind::Box2d {
                substeps: 16,
                workers: 1,
            },
            dt_s: STEP_S,
        });
        all
    }

    /// The parameters of a scene, for this configuration.
    pub fn parameters(&self, scene: &FlockParameters) -> FlockParameters {
        let mut parameters = FlockParameters {
            dt_s: self.dt_s,
            ..scene.clone()
        };
        if let Some((scheme, solver, tolerance_cm)) = self.flockenv_settings() {
            parameters.scheme = scheme;
            parameters.solver = solver;
            parameters.tolerance_cm = tolerance_cm;
        }
        parameters
    }

    /// Scheme, solver and tolerance in cm of flockenv; `None` for other engines.
    fn flockenv_settings(&self) -> Option<(Scheme, Solver, f64)> {
        match self.kind {
            Kind::Ours {
                scheme,
                solver,
                tolerance_cm,
            } => Some((scheme, solver, tolerance_cm)),
            Kind::Controlled { .. } => {
                Some((Scheme::Leapfrog, Solver::BlockPivoting, CONTROLLED_CM))
            }
            _ => None,
        }
    }

    /// The engine, set up for a scene.
    pub fn build(&self, scene: &FlockParameters, seed: u64, start: &Start) -> Box<dyn Engine> {
        let parameters = &self.parameters(scene);
        match self.kind {
            Kind::Ours { .. } => Box::new(Ours::new(parameters, seed, start)),
            Kind::Controlled { accepted_cm } => {
                Box::new(Controlled::new(parameters, seed, start, accepted_cm))
            }
            Kind::RapierF64(settings) => {
                Box::new(rapier_f64::Rapier::new(parameters, seed, start, settings))
            }
            Kind::RapierF32(settings) => {
                Box::new(rapier_f32::Rapier::new(parameters, seed, start, settings))
            }
            Kind::Box2d { substeps, workers } => {
                Box::new(Box2d::new(parameters, seed, start, substeps, workers))
            }
        }
    }

    /// The number of steps in a time in s.
    pub fn steps(&self, seconds: f64) -> usize {
        (seconds / self.dt_s).round() as usize
    }

    /// The cells of [`Self::COLUMNS`].
    pub fn cells(&self) -> Vec<String> {
        let (scheme, solver, tolerance_cm) = match self.flockenv_settings() {
            Some((scheme, solver, cm)) => (scheme.name(), solver.name(), number(cm)),
            None => ("", "", String::new()),
        };
        vec![
            text(self.engine()),
            self.setting(),
            text(scheme),
            text(solver),
            tolerance_cm,
            number(self.dt_s),
        ]
    }

    fn engine(&self) -> &'static str {
        match self.kind {
            Kind::Ours { .. } | Kind::Controlled { .. } => "flockenv",
            Kind::RapierF64(_) => "rapier2d-f64",
            Kind::RapierF32(_) => "rapier2d (f32)",
            Kind::Box2d { .. } => "Box2D (f32)",
        }
    }

    fn setting(&self) -> String {
        match self.kind {
            Kind::Ours {
                scheme,
                solver,
                tolerance_cm,
            } => {
                let gaps = if tolerance_cm < f64::INFINITY {
                    format!("{tolerance_cm:e} cm")
                } else {
                    text("linear")
                };
                format!("{} / {} / {gaps}", scheme.name(), solver.name())
            }
            Kind::Controlled { accepted_cm } => format!("controlled to {accepted_cm:e} cm"),
            Kind::RapierF64(set) => {
                rapier_setting(set.iterations, set.length_unit_cm, set.round_obstacle)
            }
            Kind::RapierF32(set) => {
                rapier_setting(set.iterations, set.length_unit_cm, set.round_obstacle)
            }
            Kind::Box2d { substeps, workers } => {
                let threads = if workers > 1 {
                    format!(" / {workers} threads")
                } else {
                    String::new()
                };
                format!("{substeps} substeps / unit 10 cm{threads}")
            }
        }
    }
}

fn rapier_setting(iterations: usize, length_unit_cm: f64, round_obstacle: bool) -> String {
    let mut parts = vec![
        format!("{iterations} iterations"),
        format!("unit {length_unit_cm} cm"),
    ];
    if round_obstacle {
        parts.push(text("round obstacle"));
    }
    parts.join(" / ")
}
