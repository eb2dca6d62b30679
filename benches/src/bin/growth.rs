//! How time and memory of a jam grow with the number of boats: `growth FOLDER [--trial]`. A program of
//! its own, since it counts every allocation.

use flockenv::{Flock, FlockParameters};
use flockenv_benches::Scene;
use flockenv_benches::measure::Effort;
use flockenv_benches::table::{Table, number, text};
use peak_alloc::PeakAlloc;
use std::path::Path;
use std::time::Instant;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const DT_S: f64 = 0.02;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = arguments.get(1).expect("growth FOLDER [--trial]");
    let is_trial = arguments.iter().any(|argument| argument == "--trial");
    let effort = if is_trial {
        Effort::Trial
    } else {
        Effort::Full
    };
    let mut table = Table::new(&[
        "n",
        "dt_s",
        "us_per_step",
        "times_real_time",
        "contacts_per_step",
        "bytes",
        "bytes_per_boat",
        "bytes_in_use_per_boat",
        "factor_entries",
        "factor_entries_per_boat",
    ]);
    for boats in effort.choose(
        vec![27, 200],
        vec![27, 50, 100, 200, 500, 1000, 2000, 5000, 10_000],
    ) {
        table.row(row(boats, effort));
    }
    table.write(Path::new(folder), "growth.csv");
}

fn row(boats: usize, effort: Effort) -> Vec<String> {
    let parameters = FlockParameters {
        dt_s: DT_S,
        ..Scene::Jam.parameters(boats)
    };
    let before = ALLOCATOR.current_usage();
    let mut flock = Flock::new(parameters, 1).expect("the boats fit");
    flock.advance(20.0, None).expect("the motion stays finite");
    let before_timing = *flock.statistics();
    let timed_s = effort.choose(2.0, if boats < 1000 { 20.0 } else { 10.0 });
    let start = Instant::now();
    flock
        .advance(timed_s, None)
        .expect("the motion stays finite");
    let time = start.elapsed().as_secs_f64();
    let bytes = (ALLOCATOR.current_usage() - before) as f64;
    // A copy allocates only the memory in use, without spare capacity.
    let copy = std::hint::black_box(flock.clone());
    let bytes_in_use = (ALLOCATOR.current_usage() - before) as f64 - bytes;
    drop(copy);
    let after = *flock.statistics();
    let (steps, n) = (
        (after.substeps - before_timing.substeps) as f64,
        boats as f64,
    );
    let entries = after.most_factor_entries as f64;
    vec![
        text(boats),
        number(DT_S),
        number(time * 1e6 / steps),
        number(timed_s / time),
        number((after.contacts - before_timing.contacts) as f64 / steps),
        number(bytes),
        number(bytes / n),
        number(bytes_in_use / n),
        number(entries),
        number(entries / n),
    ]
}
