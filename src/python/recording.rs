//! The loop of `flockenv.simulate`.

use super::arguments::{DurationS, PeriodS, SampleHz, floats, real, same_length, targets};
use super::contacts::PyContactSeries;
use super::flock::{BOAT_SUBSTEPS_A_PIECE, PyFlock};
use super::observation::observed;
use super::order::PyOrderSeries;
use super::settings::layout_from;
use crate::clock::{Ticks, ticks, whole_steps};
use crate::error::Result;
use crate::flock::{Change, Flock, Pause, Real, Recorder, Recording, Sampling};
use crate::integrator::Phase;
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};

/// The phases in the order of a cycle; samples hold their place in it.
#[pyfunction]
pub(crate) fn phase_names() -> Vec<&'static str> {
    Phase::ALL.iter().map(|phase| phase.name()).collect()
}

/// Whether each of some times (s) lies in the analysis window, by the phases then: names, shape (t,).
#[pyfunction]
pub(crate) fn sampled_analysis_window<'py>(
    py: Python<'py>,
    time_s: PyReadonlyArray1<'py, f64>,
    phase: Vec<String>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let times = time_s.to_vec()?;
    same_length("phase", phase.len(), times.len())?;
    let phases = phase.iter().map(|name| name.parse::<Phase>());
    let phases = phases.collect::<Result<Vec<_>>>()?;
    let analyzed = crate::integrator::sampled_analysis_window(&times, &phases);
    Ok(PyArray1::from_vec(py, analyzed))
}

/// How many samples a period has.
#[pyfunction]
pub(crate) fn samples_in(period_s: PeriodS, sample_hz: SampleHz) -> Result<u32> {
    whole_steps("period_s", period_s.0, sample_hz.0, "samples")
}

/// What of a run is kept besides its states, and how precisely.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct RecordingOptions {
    single_precision: bool,
    contacts: bool,
}

/// What steers at every control step: a function of the leaders' observation (k, size) that returns rudders (k,).
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Control<'py> {
    steer: Bound<'py, PyAny>,
    observation: Bound<'py, PyAny>,
    mirror_to_target: bool,
    control_hz: Bound<'py, PyAny>,
}

/// Records a run from where a flock is, which stays there: the fields of a `flockenv.Recording` that a run fills.
///
/// `changes` are times in s from the start of the run and what changes then: a target or parameters. Without
/// `control` leaders follow the steering law.
#[pyfunction]
#[pyo3(signature = (flock, duration_s, sample_hz, options, changes, control=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "as many as a run has")]
pub(crate) fn record<'py>(
    py: Python<'py>,
    flock: &PyFlock,
    duration_s: DurationS,
    sample_hz: SampleHz,
    options: RecordingOptions,
    changes: Vec<(f64, Bound<'py, PyAny>)>,
    control: Option<Control<'py>>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let sampling = Sampling::new(duration_s.0, sample_hz.0)?;
    let changes = changes
        .into_iter()
        .map(|(time_s, change)| Ok((ticks(time_s), change_from(&change)?)))
        .collect::<PyResult<Vec<_>>>()?;
    let run = Run {
        flock: flock.read()?.clone(),
        sampling,
        contacts: options.contacts,
        changes,
        control,
        progress,
    };
    if options.single_precision {
        run.recorded::<f32>(py)
    } else {
        run.recorded::<f64>(py)
    }
}

fn change_from(value: &Bound<'_, PyAny>) -> PyResult<Change> {
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    if is_list || value.is_instance_of::<PyString>() {
        return Ok(Change::Target(targets(value)?));
    }
    Ok(Change::Parameters(Box::new(value.extract()?)))
}

struct Run<'py> {
    flock: Flock,
    sampling: Sampling,
    contacts: bool,
    changes: Vec<(Ticks, Change)>,
    control: Option<Control<'py>>,
    progress: Option<Bound<'py, PyAny>>,
}

impl<'py> Run<'py> {
    fn recorded<T: Real + Element>(self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        const REPORTED_EVERY_S: f64 = 10.0;
        let boats = self.flock.parameters().n_boats;
        let leaders = self.flock.parameters().n_leaders;
        let mut recorder =
            Recorder::<T>::new(self.flock, self.sampling)?.with_changes(self.changes);
        if self.contacts {
            recorder = recorder.with_contacts();
        }
        if let Some(control) = &self.control {
            recorder = recorder.with_control(real(&control.control_hz, "control_hz")?)?;
        }
        let mut reported_s = 0.0;
        loop {
            let pause = py.detach(|| recorder.run(BOAT_SUBSTEPS_A_PIECE))?;
            match (pause, &self.control) {
                (Pause::End, _) => break,
                (Pause::Control, Some(control)) => steer(py, &mut recorder, control)?,
                _ => py.check_signals()?,
            }
            let since_s = recorder.elapsed_s() - reported_s;
            if pause == Pause::Work || since_s >= REPORTED_EVERY_S {
                if let Some(progress) = &self.progress {
                    progress.call1((since_s,))?;
                }
                reported_s += since_s;
            }
        }
        fields(py, recorder.into_recording(), boats, leaders)
    }
}

fn steer<T: Real>(
    py: Python<'_>,
    recorder: &mut Recorder<T>,
    control: &Control<'_>,
) -> PyResult<()> {
    let layout = layout_from(&control.observation, control.mirror_to_target)?;
    let observation = observed(py, recorder.flock(), layout, recorder.rudder())?;
    let rudder = control.steer.call1((observation,))?;
    let leaders = recorder.flock().parameters().n_leaders;
    Ok(recorder.steer(floats(&rudder, "rudder", &[leaders])?)?)
}

fn fields<T: Element>(
    py: Python<'_>,
    recording: Recording<T>,
    boats: usize,
    leaders: usize,
) -> PyResult<Bound<'_, PyDict>> {
    let samples = recording.time_s.len();
    let phases = recording.phase.iter().map(|phase| phase.index() as u8);
    let rows = |numbers| PyArray1::from_vec(py, numbers).reshape([samples, boats, 3]);
    let fields = PyDict::new(py);
    fields.set_item("phase", PyArray1::from_iter(py, phases))?;
    fields.set_item("order", PyOrderSeries::of(py, &recording.order))?;
    fields.set_item("time_s", PyArray1::from_vec(py, recording.time_s))?;
    let window = PyArray1::from_vec(py, recording.in_analysis_window);
    fields.set_item("in_analysis_window", window)?;
    fields.set_item("pose", rows(recording.pose)?)?;
    fields.set_item("velocity", rows(recording.velocity)?)?;
    let rudder = PyArray1::from_vec(py, recording.rudder).reshape([samples, leaders])?;
    fields.set_item("rudder", rudder)?;
    let contacts = recording.contacts.as_ref();
    let contacts = contacts.map(|samples| PyContactSeries::recorded(py, samples));
    fields.set_item("contacts", contacts.transpose()?)?;
    Ok(fields)
}
