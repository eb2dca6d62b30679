//! The loop of `flockenv.simulate`.

use super::arguments::{DurationS, SampleHz, Seed};
use super::flock::{BOAT_SUBSTEPS_A_PIECE, PyFlock};
use super::results;
use crate::flock::{Flock, Real, Recorder, Recording, Sampling};
use crate::integrator::Phase;
use crate::parameters::FlockParameters;
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The phases in the order of a cycle; samples hold their place in it.
#[pyfunction]
pub fn phase_names() -> Vec<&'static str> {
    Phase::ALL.iter().map(|phase| phase.name()).collect()
}

/// What of a run is kept besides its states, and how precisely.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Kept {
    single_precision: bool,
    contacts: bool,
}

/// Records a run under the steering law: the fields of a `flockenv.Recording` that a run fills. It goes
/// on from where `start` is, which stays there; without one, from a random start.
#[pyfunction]
#[pyo3(signature = (parameters, seed, duration_s, sample_hz, kept, progress=None, start=None))]
#[expect(clippy::too_many_arguments, reason = "the arguments of `simulate`")]
pub fn record<'py>(
    py: Python<'py>,
    parameters: FlockParameters,
    seed: Seed,
    duration_s: DurationS,
    sample_hz: SampleHz,
    kept: Kept,
    progress: Option<Bound<'py, PyAny>>,
    start: Option<PyRef<'py, PyFlock>>,
) -> PyResult<Bound<'py, PyDict>> {
    let start = start.map(|start| start.0.clone());
    let sampling = Sampling::new(duration_s.0, sample_hz.0)?;
    let contacts = kept.contacts;
    if kept.single_precision {
        let flock = placed::<f32>(py, parameters, seed.0, &sampling, start)?;
        run::<f32>(py, flock, sampling, contacts, progress.as_ref())
    } else {
        let flock = placed::<f64>(py, parameters, seed.0, &sampling, start)?;
        run::<f64>(py, flock, sampling, contacts, progress.as_ref())
    }
}

/// The flock that a run begins with; what does not fit memory is refused before boats are placed.
fn placed<T: Real>(
    py: Python<'_>,
    parameters: FlockParameters,
    seed: u64,
    sampling: &Sampling,
    start: Option<Flock>,
) -> PyResult<Flock> {
    parameters.check()?;
    Recording::<T>::with_room_for(sampling, &parameters)?;
    match start {
        Some(flock) => Ok(flock),
        None => Ok(py.detach(|| Flock::new(parameters, seed))?),
    }
}

fn run<'py, T: Real + Element>(
    py: Python<'py>,
    flock: Flock,
    sampling: Sampling,
    contacts: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let boats = flock.parameters().n_boats;
    let mut recorder = Recorder::<T>::new(flock, sampling)?;
    if contacts {
        recorder = recorder.with_contacts();
    }
    let mut told_s = 0.0;
    while !py.detach(|| recorder.run(BOAT_SUBSTEPS_A_PIECE))? {
        py.check_signals()?;
        if let Some(progress) = progress {
            let elapsed_s = recorder.elapsed_s();
            progress.call1((elapsed_s - told_s,))?;
            told_s = elapsed_s;
        }
    }
    fields(py, recorder.into_recording(), boats)
}

fn fields<T: Element>(
    py: Python<'_>,
    recording: Recording<T>,
    boats: usize,
) -> PyResult<Bound<'_, PyDict>> {
    let samples = recording.time_s.len();
    let phases = recording.phase.iter().map(|phase| phase.index() as u8);
    let rows = |numbers| PyArray1::from_vec(py, numbers).reshape([samples, boats, 3]);
    let fields = PyDict::new(py);
    fields.set_item("phase", PyArray1::from_iter(py, phases))?;
    fields.set_item("order", results::order_series(py, &recording.order)?)?;
    fields.set_item("time_s", PyArray1::from_vec(py, recording.time_s))?;
    let window = PyArray1::from_vec(py, recording.in_analysis_window);
    fields.set_item("in_analysis_window", window)?;
    fields.set_item("pose", rows(recording.pose)?)?;
    fields.set_item("velocity", rows(recording.velocity)?)?;
    let contacts = recording.contacts.as_ref();
    let contacts = contacts.map(|samples| results::contact_series(py, samples));
    fields.set_item("contacts", contacts.transpose()?)?;
    Ok(fields)
}
