//! Named sets of parameters, and where each of their numbers comes from.

use super::{FlockParameters, Noise, Pool, Scheme, Solver, Target, named_choice};

named_choice! {
    /// A named set of parameters.
    pub enum Preset ("preset") {
        /// Table 3 with `leapfrog` and white noise: the physics that does not depend on dt.
        Simulation = "simulation",
        /// Table 3 with the paper's literal scheme and per-step noise.
        Paper = "paper",
        /// Table 1, with constants fitted to Section 4, `leapfrog` and white noise.
        Experiment = "experiment",
    }
}

impl Preset {
    /// Critical noise of 27 boats of this preset in a named pool: the length of the backward phase, in
    /// s, at which mean Ψ_o of leaderless runs falls through the middle between its ordered and its
    /// disordered level. `None` for a pool in which it has not been measured.
    ///
    /// Source: `baselines/critical_noise.py` (8 seeds of 30 minutes every 0.05 s; runs in
    /// `docs/results/critical_noise.csv`; of the experiment every 0.2 s, in
    /// `docs/results/critical_noise_experiment.csv`), rounded to 0.01 s.
    pub fn critical_bw_s(self, pool: &Pool) -> Option<f64> {
        match (self, pool.name()?) {
            (Self::Simulation, "500-boats") => Some(0.31),
            (Self::Simulation, "table-1") => Some(0.45),
            (Self::Paper, "500-boats") => Some(0.57),
            (Self::Paper, "table-1") => Some(0.64),
            (Self::Experiment, "table-1") => Some(1.80),
            _ => None,
        }
    }

    /// Where the value that this preset has for a field comes from; `None` for an unknown field.
    pub fn source(self, field: &str) -> Option<&'static str> {
        let experiment = self == Self::Experiment;
        Some(match field {
            "n_boats" if experiment => "Table 1",
            "n_boats" => "Table 3 (20 to 50)",
            "n_leaders" if experiment => "Table 1 (0 to 4)",
            "n_leaders" => "Table 3 (0 or 0.2 n)",
            "pool" if experiment => "Table 1",
            "pool" => "Section 2.2 (room for 500 boats)",
            "speed_cm_s" if experiment => "Table 1 (15 ± 5)",
            "c1" | "c2" | "c3" | "c4" | "reverse_speed_cm_s" if experiment => "flockenv fit",
            "boat_radius_cm" | "boat_shape" | "gyration_radius_cm" | "speed_cm_s"
            | "reverse_speed_cm_s" | "c0" | "c1" | "c2" | "c3" | "c4" => "Table 3",
            "fw_s" | "nop1_s" | "nop2_s" => "Table 1",
            "bw_s" => match self {
                Self::Simulation => "near the critical noise",
                Self::Paper => "Section 5.2 (0.6 to 0.8)",
                Self::Experiment => "Section 4.2 (figure 5)",
            },
            "leaders_reverse" if experiment => "Section 2.6 (motor on in fw only)",
            "leaders_reverse" => "eq. (8), the same for all",
            "scheme" | "overlap_tolerance_cm" if self == Self::Paper => "Appendix A",
            "noise" if self == Self::Paper => "eq. (9), taken literally",
            "current_cap_cm_s" => "Section 4.5 (3 to 5)",
            "turning_bias" | "speed_spread_cm_s" | "current_gain" => "Section 4.5, off",
            "target"
            | "scheme"
            | "noise"
            | "solver"
            | "dt_s"
            | "overlap_tolerance_cm"
            | "relinearizations" => "chosen",
            _ => return None,
        })
    }
}

impl FlockParameters {
    /// A preset's parameters.
    pub fn preset(preset: Preset) -> Self {
        let simulation = Self {
            n_boats: 20,
            n_leaders: 0,
            pool: Pool::FIVE_HUNDRED_BOATS,
            boat_radius_cm: 5.0,
            boat_shape: 0.5,
            gyration_radius_cm: 4.74,
            speed_cm_s: 15.0,
            reverse_speed_cm_s: 15.0,
            c0: 1.0,
            c1: 1.0,
            c2: 0.1,
            c3: 1.0,
            c4: 0.1,
            fw_s: 2.0,
            nop1_s: 1.0,
            bw_s: 0.3,
            nop2_s: 1.0,
            leaders_reverse: true,
            target: Target::Clockwise,
            scheme: Scheme::Leapfrog,
            noise: Noise::White,
            solver: Solver::BlockPivoting,
            dt_s: 0.02,
            overlap_tolerance_cm: 0.01,
            relinearizations: 0,
            turning_bias: 0.0,
            speed_spread_cm_s: 0.0,
            current_gain: 0.0,
            current_cap_cm_s: 5.0,
        };
        match preset {
            Preset::Simulation => simulation,
            Preset::Paper => Self {
                bw_s: 0.6,
                scheme: Scheme::Paper,
                noise: Noise::PerStep,
                ..simulation
            },
            // Fitted by `flockenv fit` (seed 0, 110 trials); residuals in docs/model.md and
            // docs/results/experiment_fit.csv.
            Preset::Experiment => Self {
                n_boats: 27,
                pool: Pool::TABLE_1,
                reverse_speed_cm_s: 4.94,
                c1: 0.265,
                c2: 0.973,
                c3: 0.123,
                c4: 0.00584,
                bw_s: 1.4,
                leaders_reverse: false,
                ..simulation
            },
        }
    }
}
