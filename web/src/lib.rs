//! The simulator as the live page calls it: a plain C interface to a few flocks.
//!
//! JSON goes in through [`input`] and comes out through [`text`]; numbers come out as columns of `f64`. A call that
//! fails returns 0 (−1 if it returns a count). The text is then a sentence, with the name of the parameter at fault,
//! if there is one. The flocks are numbered, and each fails alone.

mod describe;
mod json;
mod leaders;
mod live;
mod request;
mod training;

use flockenv::analysis::quantities::Formula;
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::Target;
use flockenv::{Flock, FlockError, OrderParameters};
use live::{Columns, Live};
use serde_json::{Value as Json, json};
use std::cell::RefCell;
use training::Training;

/// Number of flocks that the page may run side by side: three of a game, and the law's three.
const FLOCKS: usize = 6;

#[derive(Default)]
struct Page {
    input: Vec<u8>,
    text: String,
    flocks: [Option<Live>; FLOCKS],
    /// The flock that was checked last, which takes the states of a recording.
    checked: Option<Flock>,
    training: Option<Training>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn with_page<T>(call: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(call)
}

impl Page {
    /// The request that the page wrote into the input.
    fn request(&self) -> Result<&str, FlockError> {
        std::str::from_utf8(&self.input)
            .map_err(|_| FlockError::parameter("input", "bytes", "text in UTF-8"))
    }

    /// Stores the answer of a call, and returns whether the call succeeded.
    fn answer(&mut self, answer: Result<Json, FlockError>) -> u32 {
        let succeeded = answer.is_ok();
        let answer = answer.unwrap_or_else(|error| {
            let field = match &error {
                FlockError::Parameter { field, .. } => field,
                FlockError::Placement { .. } => "n_boats",
                _ => "",
            };
            json!({ "field": field, "words": error.to_string() })
        });
        self.text = answer.to_string();
        u32::from(succeeded)
    }

    /// The open flock with this number.
    fn flock(&mut self, number: usize) -> Result<&mut Live, FlockError> {
        let live = self.flocks.get_mut(number).and_then(Option::as_mut);
        live.ok_or_else(|| FlockError::parameter("flock", number, "a flock that is open"))
    }
}

/// Memory for the next request: a number of bytes of UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    with_page(|page| {
        page.input.clear();
        page.input.resize(length, 0);
        page.input.as_mut_ptr()
    })
}

/// Address of the last call's text.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    with_page(|page| page.text.as_ptr())
}

/// Number of bytes of the last call's text.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    with_page(|page| page.text.len())
}

/// Answers with all parameters, policies, quantities, entries of an observation and colors.
#[unsafe(no_mangle)]
pub extern "C" fn describe() -> u32 {
    with_page(|page| page.answer(Ok(describe::all())))
}

/// Checks a request, and answers with all its parameters; no flock starts.
#[unsafe(no_mangle)]
pub extern "C" fn check() -> u32 {
    with_page(|page| {
        let request = page.request().and_then(request::Request::read);
        let values = request.map(|request| {
            let values = describe::values(&request.parameters);
            page.checked = Flock::new(request.parameters, request.seed).ok();
            values
        });
        page.answer(values)
    })
}

/// Answers with the recorded quantities of the flock that was checked last, in a state from JSON: the lists `pose` and
/// `velocity`, three numbers per boat. An undefined quantity is null.
#[unsafe(no_mangle)]
pub extern "C" fn recorded() -> u32 {
    with_page(|page| {
        let quantities = page.recorded_quantities();
        page.answer(quantities)
    })
}

/// A state of a recording.
#[derive(serde::Deserialize)]
struct State {
    pose: Vec<[f64; 3]>,
    velocity: Vec<[f64; 3]>,
}

impl Page {
    /// The recorded quantities of the checked flock in the state of the request.
    fn recorded_quantities(&mut self) -> Result<Json, FlockError> {
        let State { pose, velocity } = serde_json::from_str(self.request()?)
            .map_err(|error| FlockError::parameter("state", error, "JSON"))?;
        let flock = self.checked.as_mut();
        let flock =
            flock.ok_or_else(|| FlockError::parameter("flock", "none", "a checked flock"))?;
        let poses: Vec<_> = pose
            .iter()
            .map(|&[x, y, heading]| Pose::new(x, y, heading))
            .collect();
        let velocities: Vec<_> = velocity
            .iter()
            .map(|&[x, y, angular]| Velocity {
                linear: [x, y].into(),
                angular,
            })
            .collect();
        let (time_s, allow_overlap) = (0.0, true);
        flock.set_state(&poses, &velocities, time_s, allow_overlap)?;
        Ok(flock
            .recorded(Flock::WITHOUT_LEADERS)
            .map_or(Json::Null, |values| values.to_vec().into()))
    }
}

/// Starts a flock from a request. It replaces the flock that had this number.
#[unsafe(no_mangle)]
pub extern "C" fn open(flock: usize) -> u32 {
    with_page(|page| {
        let request = page.request().and_then(request::Request::read);
        let answer = request.and_then(Live::new).and_then(|live| {
            let values = describe::values(live.parameters());
            let accepted = format!("less than {FLOCKS}");
            let refuse = || FlockError::parameter("flock", flock, accepted);
            let slot = page.flocks.get_mut(flock).ok_or_else(refuse)?;
            *slot = Some(live);
            Ok(values)
        });
        page.answer(answer)
    })
}

/// Changes a flock as a request asks. `continued` says whether the flock continues from its state or starts again.
#[unsafe(no_mangle)]
pub extern "C" fn change(flock: usize) -> u32 {
    with_page(|page| {
        let request = page.request().and_then(request::Request::read);
        let answer = request.and_then(|request| {
            let live = page.flock(flock)?;
            let continues = live.change(request)?;
            let mut values = describe::values(live.parameters());
            values["continued"] = continues.into();
            Ok(values)
        });
        page.answer(answer)
    })
}

/// Closes a flock.
#[unsafe(no_mangle)]
pub extern "C" fn close(flock: usize) {
    with_page(|page| {
        if let Some(slot) = page.flocks.get_mut(flock) {
            *slot = None;
        }
    });
}

/// Starts a training from a request, and answers with its progress.
#[unsafe(no_mangle)]
pub extern "C" fn train() -> u32 {
    with_page(|page| {
        let training = page.request().and_then(Training::new);
        let answer = training.and_then(|training| page.training.insert(training).progress());
        page.answer(answer)
    })
}

/// Simulates a number of branches of the training, and answers with its progress.
#[unsafe(no_mangle)]
pub extern "C" fn learn(branches: u32) -> u32 {
    with_page(|page| {
        let missing = || FlockError::parameter("training", "none", "a training that has started");
        let training = page.training.as_mut().ok_or_else(missing);
        let progress = training.and_then(|training| {
            (0..branches).try_for_each(|_| training.advance())?;
            training.progress()
        });
        page.answer(progress)
    })
}

/// The derived quantity at this index of the table, for an order Ψ_o, its angle φ_o in rad, and a target that is
/// clockwise if `sign` is positive. NaN for a quantity that depends on more.
#[unsafe(no_mangle)]
pub extern "C" fn derived(index: usize, psi_o: f64, phi_o: f64, sign: f64) -> f64 {
    let target = if sign < 0.0 {
        Target::CounterClockwise
    } else {
        Target::Clockwise
    };
    let order = OrderParameters {
        psi_o,
        phi_o,
        ..OrderParameters::default()
    };
    match live::quantities()
        .nth(index)
        .map(|quantity| quantity.formula)
    {
        Some(Formula::Derived(formula)) => formula(&order, target),
        _ => f64::NAN,
    }
}

/// Sets the heading of the leaders that the visitor steers, from the next control step on.
#[unsafe(no_mangle)]
pub extern "C" fn steer(flock: usize, heading: f64) -> u32 {
    with_page(|page| {
        let answer = page.flock(flock).and_then(|live| live.steer(heading));
        page.answer(answer.map(|()| Json::Null))
    })
}

/// Takes up to `samples` samples within a work limit in substeps times boats; returns their number, −1 for an error.
#[unsafe(no_mangle)]
pub extern "C" fn advance(flock: usize, samples: u32, boat_substeps: u32) -> i32 {
    with_page(|page| {
        let live = page.flock(flock);
        match live.and_then(|live| live.advance(samples, u64::from(boat_substeps))) {
            Ok(taken) => taken as i32,
            Err(error) => {
                page.answer(Err(error));
                -1
            }
        }
    })
}

/// Fills the columns of contacts and of a leader's observation, as they are now. A boat that is not a leader observes
/// nothing.
#[unsafe(no_mangle)]
pub extern "C" fn look(flock: usize, boat: usize) -> u32 {
    with_page(|page| {
        let answer = page.flock(flock).and_then(|live| live.look(boat));
        page.answer(answer.map(|()| Json::Null))
    })
}

/// Address and length of a column of a flock; null and 0 if there is no such column.
fn column_of(flock: usize, column: usize) -> (*const f64, usize) {
    with_page(|page| {
        let live = page.flock(flock).ok();
        let column = live.and_then(|live| live.columns().get(column));
        column.map_or((std::ptr::null(), 0), |values| {
            (values.as_ptr(), values.len())
        })
    })
}

/// Address of a column of a flock.
#[unsafe(no_mangle)]
pub extern "C" fn column(flock: usize, column: usize) -> *const f64 {
    let (address, _) = column_of(flock, column);
    address
}

/// Length of a column of a flock.
#[unsafe(no_mangle)]
pub extern "C" fn column_length(flock: usize, column: usize) -> usize {
    let (_, length) = column_of(flock, column);
    length
}

/// Empties the columns of a flock, for the samples that follow.
#[unsafe(no_mangle)]
pub extern "C" fn take(flock: usize) {
    with_page(|page| {
        if let Ok(live) = page.flock(flock) {
            live.columns().iter_mut().for_each(Vec::clear);
        }
    });
}

/// Number of columns, in the order of [`Columns`].
#[unsafe(no_mangle)]
pub extern "C" fn columns() -> usize {
    Columns::default().len()
}
