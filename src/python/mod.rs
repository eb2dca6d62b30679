//! The Python module `flockenv._core`: call, convert, return. The only place that names pyo3 and numpy.

pub(crate) mod arguments;
pub(crate) mod batch;
pub(crate) mod contacts;
pub(crate) mod draw;
pub(crate) mod error;
pub(crate) mod exclusive;
pub(crate) mod flock;
pub(crate) mod law;
pub(crate) mod observation;
pub(crate) mod order;
pub(crate) mod parameters;
pub(crate) mod quantities;
pub(crate) mod recording;
pub(crate) mod settings;
pub(crate) mod state;
mod summary;
mod value;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use super::*;

    #[pymodule_export]
    use super::arguments::flat_actions;
    #[pymodule_export]
    use super::batch::PyEnvBatch;
    #[pymodule_export]
    use super::contacts::contact_along_cm;
    #[pymodule_export]
    use super::draw::PyFrameRenderer;
    #[pymodule_export]
    use super::flock::PyFlock;
    #[pymodule_export]
    use super::law::{PyLaw, PyObservedLaw, largest_lean, lean_feature_names};
    #[pymodule_export]
    use super::observation::{
        flock_feature_table, observation_table, observation_version, observe, rudders_of_levels,
        state_table,
    };
    #[pymodule_export]
    use super::order::{
        collective_state_names, collective_states, derived_series, order_columns, ordering_time_s,
    };
    #[pymodule_export]
    use super::parameters::{
        changed_fields, critical_bw_s, parameter_table, physics_fields, pool_radii_cm,
        preset_names, preset_sources,
    };
    #[pymodule_export]
    use super::quantities::{
        jam_sizes, lagged_motion, lap_orientation, pair_counts, quantities, structure_series,
    };
    #[pymodule_export]
    use super::recording::{phase_names, record, sampled_analysis_window};
    #[pymodule_export]
    use super::settings::{
        action_modes, decision_period_of_cycles, env_defaults, env_meanings, reward_terms,
        whole_steps_in,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::parallel::note_process();
        error::add_exceptions(module)?;
        module.add("TOWARDS_TARGET", crate::environment::TOWARDS_TARGET)?;
        module.add("USES_AVX2", cfg!(target_feature = "avx2"))?;
        module.add("JAM_ANGLE", crate::analysis::structure::JAM_ANGLE)?;
        module.add(
            "ORDERED_WITHIN",
            <(f64, f64)>::from(crate::environment::ORDERED_WITHIN),
        )?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
