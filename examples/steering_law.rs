//! Your own steering law beside the paper's, on the same seeds.
//!
//! `cargo run --release --example steering_law`

#![allow(clippy::print_stdout, reason = "an example prints what it found")]

use flockenv::Result;
use flockenv::boat::misalignment;
use flockenv::flock::Flock;
use flockenv::parameters::{FlockParameters, Preset, Target};

/// A control step: the camera takes ten frames per second.
const CONTROL_S: f64 = 0.1;
const MINUTES: f64 = 8.0;

fn main() -> Result<()> {
    let seeds = 0..8;
    let mut sums = [0.0; 2];
    for seed in seeds.clone() {
        let paper = signed_order(seed, None)?;
        let this_law = signed_order(seed, Some(law))?;
        println!("seed {seed}: paper's law {paper:6.3}, this law {this_law:6.3}");
        sums[0] += paper;
        sums[1] += this_law;
    }
    let count = seeds.count() as f64;
    println!("means: {:.3} and {:.3}", sums[0] / count, sums[1] / count);
    Ok(())
}

/// The paper's law while a boat moves forward, and no rudder while it backs: a rudder would turn it the wrong way.
fn law(misalignment: f64, forward_cm_s: f64) -> f64 {
    if forward_cm_s < 0.0 {
        0.0
    } else {
        flockenv::boat::steering_law(misalignment)
    }
}

/// The mean signed order of a flock with three leaders, after its first minute.
fn signed_order(seed: u64, law: Option<fn(f64, f64) -> f64>) -> Result<f64> {
    let parameters = FlockParameters {
        n_boats: 27,
        n_leaders: 3,
        target: Target::Clockwise.into(),
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut flock = Flock::new(parameters, seed)?;
    let (mut sum, mut samples) = (0.0, 0.0);
    while flock.time_s() < 60.0 * MINUTES {
        let rudder = law.map(|law| rudders(&flock, law));
        flock.advance(CONTROL_S, rudder.as_deref())?;
        if flock.time_s() > 60.0 {
            sum += flock
                .order_parameters(Flock::WITHOUT_LEADERS)?
                .signed_order(Target::Clockwise);
            samples += 1.0;
        }
    }
    Ok(sum / samples)
}

/// One rudder command for each leader; leaders are the first boats.
fn rudders(flock: &Flock, law: fn(f64, f64) -> f64) -> Vec<f64> {
    let parameters = flock.parameters();
    (0..parameters.n_leaders)
        .map(|leader| {
            let pose = flock.poses()[leader];
            let forward = flock.velocities()[leader]
                .linear
                .dot(&flock.hulls()[leader].axis);
            law(
                misalignment(pose.position, pose.heading, parameters.target.of(leader)),
                forward,
            )
        })
        .collect()
}
