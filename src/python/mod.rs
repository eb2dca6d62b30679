//! The Python module `flockenv._core`: call, convert, return. The only place that names pyo3 and numpy.

pub mod arguments;
pub mod batch;
pub mod collective_state;
pub mod draw;
pub mod error;
pub mod flock;
pub mod observation;
pub mod order_parameters;
pub mod parameters;
pub mod recording;
pub mod results;
pub mod settings;
pub mod structure;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use super::*;

    #[pymodule_export]
    use super::arguments::oversized_shape;
    #[pymodule_export]
    use super::batch::PyEnvBatch;
    #[pymodule_export]
    use super::collective_state::{
        collective_state_names, collective_states, off_tangents, ordering_time,
    };
    #[pymodule_export]
    use super::draw::{PyAnimationEncoder, PyFrameRenderer};
    #[pymodule_export]
    use super::flock::PyFlock;
    #[pymodule_export]
    use super::observation::{
        PyObservedLaw, level_rudders, nearest_levels, observation_table, observation_version,
        observe, state_table,
    };
    #[pymodule_export]
    use super::order_parameters::{outward, rotation, signed_order};
    #[pymodule_export]
    use super::parameters::{
        checked_fields, critical_bw_s, parameter_table, physics_fields, pool_radii_cm,
        preset_fields, preset_names, preset_sources, resized_gyration_radius_cm,
    };
    #[pymodule_export]
    use super::recording::{phase_names, record};
    #[pymodule_export]
    use super::settings::{env_defaults, env_meanings, reward_terms};
    #[pymodule_export]
    use super::structure::{
        lagged_motion, lap_orientation, largest_cluster, on_outer_wall, pair_counts,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::parallel::note_process();
        module.add("TOWARDS_TARGET", crate::environment::TOWARDS_TARGET)?;
        module.add(
            "ORDERED_WITHIN",
            <(f64, f64)>::from(crate::environment::ORDERED_WITHIN),
        )?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
