//! The loop of `flockenv.simulate`.

use super::analysis;
use super::arrays::floats;
use super::exclusive::interruptible;
use super::flock::{PyFlock, contact_columns};
use super::law::PyLaw;
use super::observation::{layout_from, observation_rows};
use super::value::argument;
use crate::clock::ticks;
use crate::environment::observation::ObservationLayout;
use crate::flock::{Change, Pause, Real, Recorder, Recording, Sampling};
use crate::parameters::Targets;
use crate::policies::Pilot;
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Plan of a run: its samples, its changes, and its steering.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Plan<'py> {
    sample_hz: Bound<'py, PyAny>,
    single_precision: bool,
    contacts: bool,
    /// Times in s from the start of the run, each with its change: a target or parameters.
    changes: Vec<(f64, Bound<'py, PyAny>)>,
    control: Control<'py>,
    /// Called now and then with the simulated seconds since the last call.
    progress: Option<Bound<'py, PyAny>>,
}

/// The steering of a run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Control<'py> {
    /// A law, or a function that is called at every control step and returns rudders (k,). Its arguments are the signs of
    /// the leaders' targets (k,) and, for each layout, the leaders' observations (k, size).
    steer: Bound<'py, PyAny>,
    /// Blocks of each layout, and whether observations of leaders with a counter-clockwise target are mirrored.
    layouts: Vec<(Bound<'py, PyAny>, bool)>,
    /// Control steps per second. `None`: the paper's law steers at every substep, and `steer` is not used.
    control_hz: Option<Bound<'py, PyAny>>,
}

/// Records a run that starts from a flock's state and leaves that flock unchanged; returns columns of a
/// `flockenv.Recording`.
#[pyfunction]
pub(super) fn record<'py>(
    py: Python<'py>,
    flock: &PyFlock,
    duration_s: &Bound<'py, PyAny>,
    plan: Plan<'py>,
) -> PyResult<Bound<'py, PyDict>> {
    let duration_s = argument(duration_s, "duration_s")?;
    let sampling = Sampling::new(duration_s, argument(&plan.sample_hz, "sample_hz")?)?;
    if plan.single_precision {
        record_as::<f32>(py, flock, sampling, &plan)
    } else {
        record_as::<f64>(py, flock, sampling, &plan)
    }
}

/// Substeps times boats between two reports of progress; they take about 30 ms.
const BOAT_SUBSTEPS_PER_REPORT: u64 = 200_000;

/// A change of parameters or, from any other value, of the target.
fn change_from(value: &Bound<'_, PyAny>) -> PyResult<Change> {
    if value.hasattr("n_boats")? {
        return Ok(Change::Parameters(Box::new(value.extract()?)));
    }
    argument::<Targets>(value, "target").map(Change::Target)
}

/// Records a run in the precision `T`. An error during the run has the columns of the samples before it as its
/// attribute `columns`.
fn record_as<'py, T: Real + Element>(
    py: Python<'py>,
    flock: &PyFlock,
    sampling: Sampling,
    plan: &Plan<'py>,
) -> PyResult<Bound<'py, PyDict>> {
    let changes = plan.changes.iter();
    let changes = changes.map(|(time_s, change)| Ok((ticks(*time_s), change_from(change)?)));
    let changes = changes.collect::<PyResult<Vec<_>>>()?;
    let recorder = Recorder::<T>::new(flock.0.read()?.clone(), sampling)?;
    let mut recorder = recorder.with_changes(changes)?;
    if plan.contacts {
        recorder = recorder.with_contacts();
    }
    let (mut layouts, mut pilot) = (Vec::new(), None);
    if let Some(control_hz) = &plan.control.control_hz {
        let control_hz = argument(control_hz, "control_hz")?;
        recorder = recorder.with_control(control_hz)?;
        for (blocks, is_mirrored) in &plan.control.layouts {
            layouts.push(layout_from(blocks, *is_mirrored)?);
        }
        if let Ok(law) = plan.control.steer.cast::<PyLaw>() {
            let law = law.get().0.clone();
            pilot = Some(Pilot::new(law, recorder.flock().parameters(), control_hz)?);
        }
    }
    let outcome = run(py, &mut recorder, pilot, &layouts, plan);
    let statistics = recorder.flock().statistics().named_overlaps();
    let columns = columns(py, recorder.into_recording())?;
    columns.set_item("statistics", statistics)?;
    if let Err(error) = outcome {
        error.value(py).setattr("columns", &columns)?;
        return Err(error);
    }
    Ok(columns)
}

/// Runs until the end, steers at control steps, and reports progress.
fn run<T: Real>(
    py: Python<'_>,
    recorder: &mut Recorder<T>,
    mut pilot: Option<Pilot>,
    layouts: &[ObservationLayout],
    plan: &Plan<'_>,
) -> PyResult<()> {
    const REPORTED_EVERY_S: f64 = 10.0;
    let mut last_report_s = 0.0;
    loop {
        let pause = interruptible(py, |keep_going| match &mut pilot {
            Some(pilot) => pilot.run(recorder, keep_going, BOAT_SUBSTEPS_PER_REPORT),
            None => recorder.run(keep_going, BOAT_SUBSTEPS_PER_REPORT),
        })?;
        match pause {
            Pause::End => return Ok(()),
            Pause::Control => steer(py, recorder, &plan.control.steer, layouts)?,
            Pause::Work => py.check_signals()?,
        }
        let unreported_s = recorder.elapsed_s() - last_report_s;
        if pause == Pause::Work || unreported_s >= REPORTED_EVERY_S {
            if let Some(progress) = &plan.progress {
                progress.call1((unreported_s,))?;
            }
            last_report_s += unreported_s;
        }
    }
}

/// Calls the function `policy`, and holds the rudders that it returns.
fn steer<T: Real>(
    py: Python<'_>,
    recorder: &mut Recorder<T>,
    policy: &Bound<'_, PyAny>,
    layouts: &[ObservationLayout],
) -> PyResult<()> {
    let (flock, held_rudders) = (recorder.flock(), recorder.rudder());
    let parameters = flock.parameters();
    let leaders = 0..parameters.n_leaders;
    let signs = leaders.map(|leader| parameters.target.of(leader).sign());
    let mut arguments = vec![PyArray1::from_iter(py, signs).into_any()];
    for layout in layouts {
        let observations = observation_rows(py, flock, *layout, held_rudders)?;
        arguments.push(observations.into_any());
    }
    let rudder = policy.call1(PyTuple::new(py, arguments)?)?;
    let rudder = floats(&rudder, "rudder", &[parameters.n_leaders])?;
    Ok(recorder.steer(rudder)?)
}

/// The columns of a recording, by name.
fn columns<T: Element>(py: Python<'_>, run: Recording<T>) -> PyResult<Bound<'_, PyDict>> {
    let samples = run.time_s.len();
    let boats = run.pose.len() / (3 * samples.max(1));
    let leaders = run.rudder.len() / samples.max(1);
    let phases = run.phase.iter().map(|phase| phase.index() as u8);
    let columns = PyDict::new(py);
    columns.set_item("phase", PyArray1::from_iter(py, phases))?;
    columns.set_item("order", analysis::columns(py, &run.order)?)?;
    columns.set_item("time_s", PyArray1::from_vec(py, run.time_s))?;
    let window = PyArray1::from_vec(py, run.in_analysis_window);
    columns.set_item("in_analysis_window", window)?;
    columns.set_item(
        "pose",
        PyArray1::from_vec(py, run.pose).reshape([samples, boats, 3])?,
    )?;
    columns.set_item(
        "velocity",
        PyArray1::from_vec(py, run.velocity).reshape([samples, boats, 3])?,
    )?;
    let rudder = PyArray1::from_vec(py, run.rudder).reshape([samples, leaders])?;
    columns.set_item("rudder", rudder)?;
    if let Some(samples) = &run.contacts {
        let contacts = contact_columns::<i32, f32>(py, &samples.contacts, |number| number as f32)?;
        let count = samples.count.iter().map(|&count| count as i64);
        contacts.set_item("count", PyArray1::from_iter(py, count))?;
        columns.set_item("contacts", contacts)?;
    }
    Ok(columns)
}
