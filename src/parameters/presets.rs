//! Named sets of parameters, with the source of each number.

use super::{FlockParameters, Noise, Pool, Scheme, named_choice};

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

named_choice! {
    /// Resolution of an environment's physics.
    pub enum Physics ("physics") {
        /// The parameters' own substep and tolerance.
        Default = "default",
        /// Coarser, for training: fewer, longer substeps.
        Training = "training",
        /// Finer, for results to publish.
        Publication = "publication",
    }
}

impl Physics {
    /// The substep in s and the tolerance in cm of this choice; `None`: those of the parameters.
    ///
    /// Source: for training, the cheapest setting of `docs/speed_vs_error.md` whose order parameters lie within three
    /// standard errors of the reference's, with the longest substep that divides a control step of 0.1 s; for
    /// publications, half the default substep, which reduces the error to a quarter.
    pub fn stepping(self) -> Option<(f64, f64)> {
        match self {
            Self::Default => None,
            Self::Training => Some((0.1, 1e-4)),
            Self::Publication => Some((0.01, 1e-6)),
        }
    }
}

/// The preset `simulation` with changed fields, and the source of each changed value.
macro_rules! changes {
    ($($name:ident = $value:expr, $source:literal;)*) => {{
        #[allow(unused_mut)]
        let mut parameters = FlockParameters::default();
        $(parameters.$name = $value;)*
        (parameters, &[$((stringify!($name), $source)),*])
    }};
}

impl Preset {
    /// Critical noise of 27 boats of this preset in a named pool: the duration in s of the backward phase at which the
    /// mean Ψ_o of leaderless runs lies halfway between its ordered and its disordered level. `None` for a pool in which
    /// it has not been measured.
    ///
    /// Source: `studies/critical_noise`, rounded to 0.01 s: 8 seeds of 30 minutes at durations 0.05 s apart (results
    /// version 1), for the experiment 0.2 s apart (version 2).
    pub fn critical_bw_s(self, pool: &Pool) -> Option<f64> {
        match (self, pool.name()?) {
            (Self::Simulation, "wide") => Some(0.31),
            (Self::Simulation, "narrow") => Some(0.45),
            (Self::Paper, "wide") => Some(0.57),
            (Self::Paper, "narrow") => Some(0.64),
            (Self::Experiment, "narrow") => Some(1.49),
            _ => None,
        }
    }

    /// Source of this preset's value of a field; `None` for an unknown field.
    pub fn source(self, field: &str) -> Option<&'static str> {
        let (_, changes) = self.changes();
        let change = changes.iter().find(|(name, _)| *name == field);
        let declaration = FlockParameters::FIELDS
            .iter()
            .find(|declaration| declaration.name == field);
        change
            .map(|(_, source)| *source)
            .or_else(|| declaration.map(|declaration| declaration.source))
    }

    /// The preset's parameters, and the sources of the values that differ from the preset `simulation`.
    fn changes(self) -> (FlockParameters, &'static [(&'static str, &'static str)]) {
        match self {
            Self::Simulation => changes! {},
            Self::Paper => changes! {
                bw_s = 0.6, "Section 5.2 (0.6 to 0.8)";
                scheme = Scheme::Paper, "Appendix A";
                noise_scheme = Noise::PerStep, "eq. (9), taken literally";
                overlap_tolerance_cm = 0.01, "Appendix A";
            },
            Self::Experiment => changes! {
                n_boats = 27, "Table 1";
                n_leaders = 0, "Table 1 (0 to 4)";
                pool = Pool::NARROW, "Table 1";
                speed_cm_s = 17.93, "fitted to Section 4 (docs/model.md)";
                reverse_speed_cm_s = 8.2, "fitted to Section 4 (docs/model.md)";
                c0 = 0.8263, "fitted to Section 4 (docs/model.md)";
                c1 = 0.651, "fitted to Section 4 (docs/model.md)";
                c2 = 0.5402, "fitted to Section 4 (docs/model.md)";
                c3 = 0.1906, "fitted to Section 4 (docs/model.md)";
                c4 = 0.05159, "fitted to Section 4 (docs/model.md)";
                bw_s = 1.4, "Section 4.2 (figure 5)";
                leaders_reverse = false, "Section 2.6 (motor on in fw only)";
                turning_bias = 0.0002426, "fitted to Section 4 (docs/model.md)";
                speed_spread_cm_s = 0.983, "fitted to Section 4 (docs/model.md)";
                current_gain = 0.04248, "fitted to Section 4 (docs/model.md)";
                leader_speed_factor = 1.106, "fitted to Section 4 (docs/model.md)";
            },
        }
    }
}

impl FlockParameters {
    /// A preset's parameters.
    pub fn preset(preset: Preset) -> Self {
        preset.changes().0
    }
}
