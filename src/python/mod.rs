//! The Python module `flockenv._core`: call, convert, return. The only place that names pyo3 and numpy.

mod analysis;
mod arrays;
mod batch;
mod error;
mod exclusive;
mod flock;
mod law;
mod observation;
mod parameters;
mod recording;
mod tables;
mod training;
mod value;

use pyo3::prelude::*;

use crate::draw::palette::Rgb;
use crate::parameters::Value;

#[pymodule]
mod _core {
    use super::*;
    use crate::analysis::CollectiveState;
    use crate::analysis::quantities::{QUANTITIES, Quantity};
    use crate::draw::palette::{OKABE_ITO, PALETTE, style_sheet};
    use crate::environment::observation::{
        LeanFeatures, OBSERVATION_VERSION, flock_feature_entries,
    };
    use crate::environment::{
        ActionMode, EnvSettings, LARGEST_LEAN, ORDERED_WITHIN, RewardTerm, TOWARDS_TARGET,
    };
    use crate::integrator::Phase;
    use crate::parameters::{Field, FlockParameters, Preset};
    use crate::policies::{Law, NamedLaw};
    use crate::training::BranchSettings;

    #[pymodule_export]
    use super::analysis::{
        collective_states, derived_series, jam_sizes, lap_orientation, order_columns,
        ordering_time_s, sampled_analysis_window, structure_series, track_velocities,
    };
    #[pymodule_export]
    use super::arrays::{flat_actions, linear};
    #[pymodule_export]
    use super::batch::PyEnvBatch;
    #[pymodule_export]
    use super::flock::{PyFlock, PyFrameRenderer};
    #[pymodule_export]
    use super::law::{PyLaw, PyObservedLaw};
    #[pymodule_export]
    use super::observation::{observation_table, observe, state_table};
    #[pymodule_export]
    use super::parameters::PyParameters;
    #[pymodule_export]
    use super::recording::record;
    #[pymodule_export]
    use super::tables::{
        critical_bw_s, decisions_in, physics_fields, pool_radii_cm, preset_sources,
        rudders_of_levels,
    };
    #[pymodule_export]
    use super::training::PyTrainer;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::parallel::note_process();
        error::add_exceptions(module)?;
        module.add("ACTION_MODES", ActionMode::names())?;
        module.add("STYLE_SHEET", style_sheet())?;
        let colors = PALETTE.iter().map(|swatch| (swatch.name, swatch.light));
        module.add("PALETTE", by_name(colors))?;
        module.add("OKABE_ITO", by_name(OKABE_ITO.iter().copied()))?;
        module.add("COLLECTIVE_STATES", CollectiveState::names())?;
        let laws = Law::NAMED.iter().map(NamedLaw::declaration);
        module.add("LAWS", Value::List(laws.collect()))?;
        module.add("LEAN_FEATURES", LeanFeatures::names().collect::<Vec<_>>())?;
        module.add("PHASES", Phase::names())?;
        module.add("PRESETS", Preset::names())?;
        let fields = FlockParameters::FIELDS.iter().map(Field::declaration);
        module.add("PARAMETERS", Value::List(fields.collect()))?;
        let fields = EnvSettings::FIELDS.iter().map(Field::declaration);
        module.add("OPTIONS", Value::List(fields.collect()))?;
        let fields = BranchSettings::FIELDS.iter().map(Field::declaration);
        module.add("BRANCH_OPTIONS", Value::List(fields.collect()))?;
        let quantities = QUANTITIES.iter().map(Quantity::declaration);
        module.add("QUANTITIES", Value::List(quantities.collect()))?;
        let features = flock_feature_entries().into_iter();
        let features = features.map(|(block, entry)| entry.named(block, 0));
        module.add("FLOCK_FEATURES", Value::List(features.collect()))?;
        let terms = RewardTerm::ALL.iter();
        let terms: Vec<_> = terms.map(|term| (term.name(), term.doc())).collect();
        module.add("REWARD_TERMS", terms)?;
        module.add("OBSERVATION_VERSION", OBSERVATION_VERSION)?;
        module.add("TOWARDS_TARGET", TOWARDS_TARGET)?;
        module.add("ORDERED_WITHIN", <(f64, f64)>::from(ORDERED_WITHIN))?;
        module.add("LARGEST_LEAN", LARGEST_LEAN)?;
        module.add("USES_AVX2", cfg!(target_feature = "avx2"))?;
        module.add("HAS_AVX2", has_avx2())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// Colors by name, in the notation of style sheets.
fn by_name(colors: impl Iterator<Item = (&'static str, Rgb)>) -> Value {
    let texts = colors.map(|(name, color)| (name, Value::from(color.to_string())));
    texts.collect()
}

/// Whether this processor has AVX2.
fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::is_x86_feature_detected!("avx2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}
