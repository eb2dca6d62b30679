//! Instructions of a substep and of a control step, counted by valgrind's callgrind and held against
//! `instructions.csv`: counts do not depend on what else the machine does.
//!
//! `cargo bench --bench instructions` compares, `-- --write` measures again, `-- --strict` fails where valgrind
//! is missing. Callgrind's own files stay in `target/instructions`, for `callgrind_annotate`.

mod support;

use flockenv::Flock;
use flockenv::contact::Statistics;
use flockenv::environment::{EnvBatch, EnvSettings, Episode};
use flockenv::parameters::{Disc, FlockParameters, Pool};
use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use support::scene::Scene;
use support::{control, environment, leaning, training, warm_batch};

/// Fraction by which a count may differ from the pinned one: compilers and processors' memcpy differ.
const TOLERANCE: f64 = 0.03;
const PINNED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.csv");
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/instructions");
const HEADER: &str = "scene,instructions per step,per boat and substep,per contact and substep";

type Failure = Box<dyn std::error::Error>;

/// The counted work: substeps of a flock, or control steps of the flocks of an environment.
enum Work {
    Flock(FlockParameters),
    Environment(FlockParameters),
    /// Control steps of many flocks whose leaders lean once a second, as in `flockenv train`.
    Leaning(FlockParameters),
}

/// Number of flocks of one seed if leaders lean: the four seeds have the 128 flocks of a training.
const LEANING_FLOCKS: u64 = 32;

/// The work that was counted.
struct Counted {
    steps: u64,
    boats: u64,
    statistics: Statistics,
}

fn work(name: &str) -> Option<Work> {
    let flock = |scene: Scene, boats, tolerance_cm| {
        Work::Flock(FlockParameters {
            dt_s: 0.01,
            tolerance_cm,
            ..scene.parameters(boats)
        })
    };
    Some(match name {
        "jam of 27, linearized once" => flock(Scene::Jam, 27, f64::INFINITY),
        "jam of 27" => flock(Scene::Jam, 27, 1e-4),
        "jam of 27, 1e-6 cm" => flock(Scene::Jam, 27, 1e-6),
        "jam of 27, 1e-9 cm" => flock(Scene::Jam, 27, 1e-9),
        "cycle of 27, linearized once" => flock(Scene::Cycle, 27, f64::INFINITY),
        "cycle of 27" => flock(Scene::Cycle, 27, 1e-4),
        "cycle of 27, 1e-6 cm" => flock(Scene::Cycle, 27, 1e-6),
        "cycle of 27 with 300 posts" => Work::Flock(with_posts(Scene::Cycle.parameters(27))),
        "jam of 1000, linearized once" => flock(Scene::Jam, 1000, f64::INFINITY),
        "jam of 1000" => flock(Scene::Jam, 1000, 1e-4),
        "jam of 1000, 1e-6 cm" => flock(Scene::Jam, 1000, 1e-6),
        "control step in wide" => Work::Environment(environment(Pool::WIDE, 0.3)),
        "control step in narrow" => Work::Environment(environment(Pool::NARROW, 0.4)),
        "training control step in wide" => Work::Environment(training(Pool::WIDE, 0.31)),
        "training control step in narrow" => Work::Environment(training(Pool::NARROW, 0.45)),
        "training of leans in wide" => Work::Leaning(fewer_leaders(training(Pool::WIDE, 0.31))),
        "training of leans in narrow" => Work::Leaning(fewer_leaders(training(Pool::NARROW, 0.45))),
        _ => return None,
    })
}

fn fewer_leaders(parameters: FlockParameters) -> FlockParameters {
    FlockParameters {
        n_leaders: 3,
        ..parameters
    }
}

/// Discs of 2 cm along the outer wall, which are 1 cm in the water.
fn with_posts(parameters: FlockParameters) -> FlockParameters {
    let outer = parameters.pool.outer_radius_cm;
    let posts = (0..300).map(|post| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(post) / 300.0);
        Disc {
            x_cm: (outer + 1.0) * cos,
            y_cm: (outer + 1.0) * sin,
            radius_cm: 2.0,
        }
    });
    FlockParameters {
        dt_s: 0.01,
        discs: posts.collect(),
        ..parameters
    }
}

const SCENES: [&str; 17] = [
    "jam of 27, linearized once",
    "jam of 27",
    "jam of 27, 1e-6 cm",
    "jam of 27, 1e-9 cm",
    "cycle of 27, linearized once",
    "cycle of 27",
    "cycle of 27, 1e-6 cm",
    "cycle of 27 with 300 posts",
    "jam of 1000, linearized once",
    "jam of 1000",
    "jam of 1000, 1e-6 cm",
    "control step in wide",
    "control step in narrow",
    "training control step in wide",
    "training control step in narrow",
    "training of leans in wide",
    "training of leans in narrow",
];

/// Number of seeds over which counts are averaged.
const SEEDS: u64 = 4;

impl Work {
    /// The state of a seed after 20 s, which would take minutes in callgrind.
    fn warmed_up(&self, seed: u64) -> Result<Vec<u8>, Failure> {
        match self {
            Self::Flock(parameters) => {
                let mut flock = Flock::new(parameters.clone(), seed)?;
                flock.advance(20.0, None)?;
                Ok(flock.snapshot())
            }
            Self::Environment(parameters) => {
                let batch = warm_batch(EnvSettings::default(), parameters, seed..seed + 1)?;
                Ok(batch.to_bytes())
            }
            Self::Leaning(parameters) => {
                let seeds = LEANING_FLOCKS * seed..LEANING_FLOCKS * (seed + 1);
                Ok(warm_batch(leaning(), parameters, seeds)?.to_bytes())
            }
        }
    }

    /// Continues from a state: a short time uncounted, then a cycle of phases (half a second for a large flock) counted.
    fn count(&self, state: &[u8]) -> Result<Counted, Failure> {
        match self {
            Self::Flock(parameters) => {
                let mut flock = Flock::from_snapshot(state, None)?;
                flock.advance(0.05, None)?;
                let before = *flock.statistics();
                let duration_s = if parameters.n_boats > 100 { 0.5 } else { 6.0 };
                counted(|| flock.advance(black_box(duration_s), None))?;
                let statistics = difference(flock.statistics(), &before);
                Ok(Counted {
                    steps: statistics.substeps,
                    boats: parameters.n_boats as u64,
                    statistics,
                })
            }
            Self::Environment(parameters) | Self::Leaning(parameters) => {
                let mut batch = EnvBatch::from_bytes(state)?;
                let settings = batch.settings();
                let (hz, period) = (settings.control_hz, settings.period_steps());
                control(&mut batch, 2)?;
                let before = statistics(&batch);
                let cycle_s =
                    parameters.fw_s + parameters.nop1_s + parameters.bw_s + parameters.nop2_s;
                let decisions = (cycle_s * hz / f64::from(period)).round() as u64;
                counted(|| control(&mut batch, decisions))?;
                Ok(Counted {
                    steps: decisions * u64::from(period) * batch.envs().len() as u64,
                    boats: parameters.n_boats as u64,
                    statistics: difference(&statistics(&batch), &before),
                })
            }
        }
    }
}

/// Sums over all flocks of a batch.
fn statistics(batch: &EnvBatch) -> Statistics {
    let episodes = batch.envs().iter().filter_map(|env| env.episode());
    episodes
        .map(Episode::flock)
        .fold(Statistics::default(), |sum, flock| {
            let statistics = flock.statistics();
            Statistics {
                substeps: sum.substeps + statistics.substeps,
                contacts: sum.contacts + statistics.contacts,
                ..sum
            }
        })
}

fn difference(now: &Statistics, before: &Statistics) -> Statistics {
    Statistics {
        substeps: now.substeps - before.substeps,
        contacts: now.contacts - before.contacts,
        ..*now
    }
}

/// Callgrind counts only instructions within this function.
#[inline(never)]
fn counted<R>(work: impl FnOnce() -> R) -> R {
    black_box(work())
}

/// A scene's row of the table: instructions per step, per boat and substep, and per contact and substep.
fn measure(name: &str) -> Result<String, Failure> {
    let (mut instructions, mut sums) = (0, [0; 4]);
    for seed in 1..=SEEDS {
        let file = |kind: &str| PathBuf::from(FOLDER).join(format!("{name}.{seed}.{kind}"));
        let (state, profile) = (file("state"), file("callgrind"));
        let warmed_up = work(name).ok_or("no such scene")?.warmed_up(seed)?;
        fs::write(&state, warmed_up)?;
        let output = Command::new("valgrind")
            .args([
                "--tool=callgrind",
                "--toggle-collect=*instructions*counted*",
            ])
            .arg(format!("--callgrind-out-file={}", profile.display()))
            .arg(std::env::current_exe()?)
            .args(["--count", name])
            .arg(&state)
            // Callgrind collects the thread that calls `counted`.
            .env("RAYON_NUM_THREADS", "1")
            .output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
        }
        instructions += total(&profile)?;
        let reported = String::from_utf8(output.stdout)?;
        for (sum, word) in sums.iter_mut().zip(reported.split_whitespace()) {
            *sum += word.parse::<u64>()?;
        }
    }
    let [steps, substeps, boats, contacts] = sums.map(|sum| sum as f64);
    let all = instructions as f64;
    let per_boat = all * SEEDS as f64 / (substeps * boats);
    Ok(format!(
        "\"{name}\",{:.0},{per_boat:.1},{:.0}",
        all / steps,
        all / contacts
    ))
}

/// The number of instructions in a callgrind file.
fn total(profile: &Path) -> Result<u64, Failure> {
    let text = fs::read_to_string(profile)?;
    let mut lines = text.lines();
    let line = lines.find_map(|line| {
        line.strip_prefix("totals: ")
            .or(line.strip_prefix("summary: "))
    });
    Ok(line.ok_or("no totals")?.trim().parse()?)
}

/// Runs in valgrind: prints steps, substeps, boats and contacts.
fn count(name: &str, state: &str) -> Result<(), Failure> {
    let done = work(name)
        .ok_or("no such scene")?
        .count(&fs::read(state)?)?;
    let statistics = done.statistics;
    let numbers = [
        done.steps,
        statistics.substeps,
        done.boats,
        statistics.contacts,
    ];
    say(&numbers.map(|number| number.to_string()).join(" "));
    Ok(())
}

#[allow(clippy::print_stdout, reason = "a command's output")]
fn say(line: &str) {
    println!("{line}");
}

/// The first number of a row, and the name before it.
fn row(line: &str) -> Option<(&str, f64)> {
    let (name, numbers) = line.strip_prefix('"')?.split_once("\",")?;
    Some((name, numbers.split(',').next()?.parse().ok()?))
}

/// A sentence on how a row differs from the pinned one; `None` if it is within the tolerance.
fn mismatch(line: &str, pinned: &str) -> Option<String> {
    let (name, now) = row(line)?;
    let Some((_, then)) = pinned
        .lines()
        .filter_map(row)
        .find(|(known, _)| *known == name)
    else {
        return Some(format!("{name}: nothing is pinned"));
    };
    let change = now / then - 1.0;
    (change.abs() > TOLERANCE).then(|| {
        let percent = 100.0 * change;
        format!("{name}: {now} instructions per step, {percent:+.1} % from the pinned {then}")
    })
}

fn run(arguments: &[String]) -> Result<ExitCode, Failure> {
    if let [first, name, state] = arguments
        && first == "--count"
    {
        count(name, state)?;
        return Ok(ExitCode::SUCCESS);
    }
    let has = |option: &str| arguments.iter().any(|argument| argument == option);
    if Command::new("valgrind").arg("--version").output().is_err() {
        say(
            "NOT COUNTED: there is no valgrind here (on Debian and Ubuntu: apt-get install valgrind)",
        );
        return Ok(ExitCode::from(u8::from(has("--strict"))));
    }
    fs::create_dir_all(FOLDER)?;
    let mut table = format!("{HEADER}\n");
    say(HEADER);
    for name in SCENES {
        let line = measure(name)?;
        say(&line);
        writeln!(table, "{line}")?;
    }
    if has("--write") {
        fs::write(PINNED, table)?;
        return Ok(ExitCode::SUCCESS);
    }
    let pinned = fs::read_to_string(PINNED)?;
    let mismatches: Vec<_> = table
        .lines()
        .filter_map(|line| mismatch(line, &pinned))
        .collect();
    for line in &mismatches {
        say(line);
    }
    Ok(ExitCode::from(u8::from(!mismatches.is_empty())))
}

fn main() -> Result<ExitCode, Failure> {
    // Cargo adds `--bench`.
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    run(&arguments)
}
