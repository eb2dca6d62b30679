//! The Python module `flockenv._core`: call, convert, return. The only place that names pyo3 and numpy.

pub(crate) mod arguments;
pub(crate) mod batch;
pub(crate) mod contacts;
pub(crate) mod draw;
pub(crate) mod error;
pub(crate) mod exclusive;
pub(crate) mod flock;
pub(crate) mod observation;
pub(crate) mod order;
pub(crate) mod parameters;
pub(crate) mod quantities;
pub(crate) mod recording;
pub(crate) mod result;
pub(crate) mod settings;
pub(crate) mod state;
pub(crate) mod statistics;
pub(crate) mod structure;
mod summary;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use super::*;

    #[pymodule_export]
    use super::arguments::oversized_shape;
    #[pymodule_export]
    use super::batch::PyEnvBatch;
    #[pymodule_export]
    use super::contacts::{PyContactSeries, PyContacts, contact_along_cm};
    #[pymodule_export]
    use super::draw::PyFrameRenderer;
    #[pymodule_export]
    use super::flock::PyFlock;
    #[pymodule_export]
    use super::observation::{
        PyObservedLaw, flock_feature_table, level_rudders, nearest_levels, observation_table,
        observation_version, observe, state_table, tuned_gains,
    };
    #[pymodule_export]
    use super::order::{PyOrderParameters, PyOrderSeries, collective_state_names, order_series};
    #[pymodule_export]
    use super::parameters::{
        checked_fields, critical_bw_s, parameter_table, physics_fields, pool_radii_cm,
        preset_fields, preset_names, preset_sources, resized_gyration_radius_cm,
        set_parameters_class,
    };
    #[pymodule_export]
    use super::quantities::{PyQuantity, quantities};
    #[pymodule_export]
    use super::recording::{phase_names, record, sampled_analysis_window, samples_in};
    #[pymodule_export]
    use super::settings::{
        action_modes, decision_period_of_cycles, env_defaults, env_meanings, held_decisions,
        reward_terms,
    };
    #[pymodule_export]
    use super::statistics::PyStatistics;
    #[pymodule_export]
    use super::structure::{
        jam_sizes, lagged_motion, lap_orientation, largest_cluster, on_outer_wall, pair_counts,
        polarization,
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
