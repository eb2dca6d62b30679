//! Whatever is asked of a flock, every control step either keeps the promises or fails and changes nothing: no overlap is
//! deeper than the tolerance, no boat is outside the water, and without motors and rudders energy never rises: with drag and
//! `leapfrog` not at all, else by what contacts seem to add along curves.
//!
//! Scenes go through presets, pools, the three physics, backward durations of 0.2 to 2.8 s and speeds of 5 to 60 cm/s, half a
//! minute each. In a quarter of them nothing drives the boats, in half of these nothing but contacts slows them. The long form, `cargo test --release -- --ignored soak`, takes SOAK_STEPS control steps, ten million unless
//! the environment says otherwise, from scene SOAK_FIRST on.

use crate::support::{bits, changed, kinetic_energy};
use flockenv::geometry::Velocity;
use flockenv::parameters::{Physics, Pool, Preset, Scheme};
use flockenv::{Flock, FlockError, FlockParameters};
use std::collections::BTreeMap;

/// Control steps of a scene.
const STEPS: usize = 300;
/// Part of its energy that a control step may add to a flock without drag, and each halving of a substep once more: what
/// an island may gain before its substep is halved.
const MOST_GAIN: f64 = 0.01;

/// What a soak came to.
#[derive(Debug, Default)]
struct Soak {
    steps: usize,
    substeps: u64,
    halved: u64,
    unsolved: u64,
    failed: usize,
    /// Deepest overlap over the tolerance.
    deepest: f64,
    /// Control steps without motors and rudders, and the largest gain of energy in one, by scheme, substep and drag.
    gains: BTreeMap<String, (usize, f64)>,
}

/// The fraction that draw `k` has in direction `i`: points that fill a cube evenly (powers of the root of x^7 = x + 1).
fn drawn(k: usize, i: i32) -> f64 {
    let root = 1.112_775_684_278_706_f64;
    (0.5 + (k as f64 + 1.0) / root.powi(i + 1)).fract()
}

/// Scene `k`, and whether motors and rudders drive its boats.
fn scene(k: usize) -> (FlockParameters, bool) {
    let presets = Preset::ALL;
    let pools = [Pool::WIDE, Pool::NARROW];
    let speed = 5.0 + 55.0 * drawn(k, 0);
    let runs = k % 4 != 3;
    let p = changed(FlockParameters::preset(presets[k % presets.len()]), |p| {
        p.n_boats = 15 + (25.0 * drawn(k, 1)) as usize;
        p.n_leaders = 3;
        p.pool = pools[(drawn(k, 2) * 2.0) as usize];
        p.bw_s = 0.2 + 2.6 * drawn(k, 3);
        (p.speed_cm_s, p.reverse_speed_cm_s) = (speed, speed);
        let physics = Physics::ALL[(drawn(k, 4) * Physics::ALL.len() as f64) as usize];
        if let Some(stepping) = physics.stepping() {
            (p.dt_s, p.tolerance_cm) = stepping;
        }
        if !runs {
            // A rudder turns what moves, and the weathervane spins up what backs, at no cost of speed.
            (p.fw_s, p.bw_s, p.c2, p.c3) = (0.0, 0.0, 0.0, 0.0);
            (p.c4, p.current_gain) = (0.0, 0.0);
        }
        if k % 8 == 7 {
            (p.c0, p.c1) = (0.0, 0.0);
        }
    });
    (p, runs)
}

fn placed(k: usize, p: &FlockParameters, runs: bool) -> Flock {
    let mut flock = Flock::new(p.clone(), k as u64).expect("room");
    if !runs {
        let poses = flock.poses().to_vec();
        let thrown: Vec<_> = (0..poses.len())
            .map(|boat| {
                let (sin, cos) = (2.4 * boat as f64).sin_cos();
                Velocity::new(p.speed_cm_s * cos, p.speed_cm_s * sin, sin)
            })
            .collect();
        flock
            .set_state(&poses, &thrown, 0.0, false)
            .expect("as placed");
    }
    flock
}

/// Part of its energy that a flock without motors and rudders has gained, and the most that it may gain.
fn gained(flock: &Flock, before: f64, halved: i32) -> (f64, f64) {
    let p = flock.parameters();
    if p.scheme == Scheme::Leapfrog && p.c0 > 0.0 {
        return (kinetic_energy(flock) / before - 1.0, 0.0);
    }
    // What was left of an overlap opens at some tolerance/dt.
    let opening = p.n_boats as f64 * (p.allowed_overlap_cm() / p.dt_s).powi(2);
    let most = (1.0 + MOST_GAIN).powi(1 + halved) - 1.0;
    ((kinetic_energy(flock) - opening) / before - 1.0, most)
}

impl Soak {
    fn run(&mut self, k: usize) {
        let (p, runs) = scene(k);
        let mut flock = placed(k, &p, runs);
        for step in 0..STEPS {
            let (energy, before) = (kinetic_energy(&flock), bits(&flock));
            let halved = flock.statistics().halved_substeps;
            let turn = (step / 5 + k) % 3;
            let rudder = [1.0, -1.0, turn as f64 - 1.0];
            self.steps += 1;
            match flock.advance(0.1, Some(&rudder)) {
                Ok(()) => {}
                Err(FlockError::Solver(_)) => {
                    assert_eq!(bits(&flock), before, "scene {k}, step {step}");
                    self.failed += 1;
                    break;
                }
                other => panic!("scene {k}, step {step}: {other:?}"),
            }
            for pose in flock.poses() {
                let distance = pose.position.norm();
                let water = p.pool.inner_radius_cm..=p.pool.outer_radius_cm;
                assert!(
                    water.contains(&distance),
                    "scene {k}, step {step}: {pose:?}"
                );
            }
            if !runs {
                let halved = flock.statistics().halved_substeps - halved;
                let (gain, most) = gained(&flock, energy, halved as i32);
                let name = format!("{}, {} s, drag {}", p.scheme.name(), p.dt_s, p.c0);
                let (steps, largest) = self.gains.entry(name).or_default();
                (*steps, *largest) = (*steps + 1, largest.max(gain));
                assert!(gain <= most, "scene {k}, step {step}: {gain}");
            }
        }
        let statistics = flock.statistics();
        let deepest = statistics.worst_overlap_cm / p.allowed_overlap_cm();
        assert!(deepest <= 1.0 + 1e-6, "scene {k}: {statistics:?} {p:?}");
        self.deepest = self.deepest.max(deepest);
        self.substeps += statistics.substeps;
        self.halved += statistics.halved_substeps;
        self.unsolved += statistics.unsolved;
    }
}

fn soak(first: usize, steps: usize) -> Soak {
    let mut soak = Soak::default();
    for k in first..first + steps.div_ceil(STEPS) {
        soak.run(k);
    }
    assert!(soak.steps * 10 >= steps * 9, "{soak:?}");
    soak
}

#[test]
fn thirty_thousand_control_steps_keep_every_promise() {
    let soak = soak(0, 30_000);
    assert_eq!((soak.unsolved, soak.failed), (0, 0), "{soak:?}");
}

#[test]
#[ignore = "ten million control steps: an hour of computing"]
#[allow(clippy::print_stderr, reason = "counts of a run of an hour")]
fn soak_ten_million_control_steps() {
    let number = |name: &str, default| {
        std::env::var(name).map_or(default, |number| number.parse().expect("a count"))
    };
    let (first, steps) = (number("SOAK_FIRST", 0), number("SOAK_STEPS", 10_000_000));
    eprintln!("{:#?}", soak(first, steps));
}
