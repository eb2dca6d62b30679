//! Training in paired branches.

use super::exclusive::{Exclusive, interruptible};
use super::law::PyLaw;
use super::parameters::PyParameters;
use super::value::set_fields;
use crate::error::Result;
use crate::parameters::{Field, FlockParameters, Value};
use crate::policies::Law;
use crate::training::{BranchSettings, Trainer};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// A training under way.
#[pyclass(name = "Trainer", module = "flockenv._core", frozen)]
pub(super) struct PyTrainer(Exclusive<Trainer>);

impl PyTrainer {
    fn wrap(trainer: Trainer) -> Self {
        Self(Exclusive::new(trainer, "the training"))
    }
}

#[pymethods]
impl PyTrainer {
    /// A training at its start. Its flocks have the consecutive seeds from `first_seed` on.
    #[new]
    fn new(
        parameters: FlockParameters,
        options: &Bound<'_, PyDict>,
        seed: u64,
        first_seed: u64,
    ) -> PyResult<Self> {
        // The options are set twice, since the defaults of the others depend on the action mode.
        let mut settings = BranchSettings::default();
        set_fields(&mut settings, BranchSettings::FIELDS, options)?;
        settings = BranchSettings::usual(settings.action_mode);
        set_fields(&mut settings, BranchSettings::FIELDS, options)?;
        Ok(Self::wrap(Trainer::new(
            settings, parameters, seed, first_seed,
        )?))
    }

    /// A training from its bytes. It ends at `flock_hours`; `None`: at the end that it was started with.
    #[staticmethod]
    #[pyo3(signature = (state, flock_hours=None))]
    fn from_bytes(state: &[u8], flock_hours: Option<f64>) -> Result<Self> {
        let trainer = Trainer::from_bytes(state)?;
        let trainer = flock_hours.map_or(Ok(trainer.clone()), |hours| trainer.until(hours))?;
        Ok(Self::wrap(trainer))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.0.read()?.to_bytes()))
    }

    /// Runs up to this many more branches, each of one pair of flocks.
    fn advance(&self, py: Python<'_>, branches: usize) -> PyResult<()> {
        let mut trainer = self.0.write()?;
        let trainer = &mut *trainer;
        interruptible(py, |keep_going| trainer.advance(keep_going, branches))
    }

    #[getter]
    fn has_ended(&self) -> Result<bool> {
        Ok(self.0.read()?.has_ended())
    }

    /// Flock-hours so far, and at the end of the training.
    #[getter]
    fn flock_hours(&self) -> Result<(f64, f64)> {
        Ok(self.0.read()?.flock_hours())
    }

    /// Flock-hours and mean order at each round.
    #[getter]
    fn curve(&self) -> Result<Vec<(f64, f64)>> {
        Ok(self.0.read()?.curve().collect())
    }

    /// Number of branches, number of branches that left overlaps deeper than the tolerance, and the deepest overlap in cm.
    #[getter]
    fn overlaps(&self) -> Result<(u64, u64, f64)> {
        Ok(self.0.read()?.overlaps())
    }

    #[getter]
    fn law(&self) -> Result<PyLaw> {
        Ok(PyLaw(Law::Leaning(Box::new(self.0.read()?.law()?))))
    }

    #[getter]
    fn options(&self) -> Result<Value> {
        Ok(Field::values(
            BranchSettings::FIELDS,
            self.0.read()?.settings(),
        ))
    }

    #[getter]
    fn parameters(&self) -> Result<PyParameters> {
        Ok(PyParameters(self.0.read()?.parameters().clone()))
    }
}
