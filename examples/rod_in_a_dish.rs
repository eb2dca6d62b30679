//! Self-propelled rods in a dish: do they swim along the wall together, and how does that depend on their shape?
//!
//! `cargo run --release --example rod_in_a_dish`

#![allow(clippy::print_stdout, reason = "an example prints what it found")]

use flockenv::Result;
use flockenv::analysis::quantities::QUANTITIES;
use flockenv::flock::Flock;
use flockenv::parameters::{FlockParameters, Pool, Preset};

/// The recorded quantities to print; `QUANTITIES` says what each means.
const NAMES: [&str; 3] = ["psi_o", "nematic", "milling"];

fn main() -> Result<()> {
    println!("boat_shape      {}", NAMES.join("   "));
    for boat_shape in [0.0, 0.5, 1.0, 2.0, 5.0] {
        let [order, nematic, milling] = means(boat_shape)?;
        println!("{boat_shape:10.1}   {order:8.2}   {nematic:7.2}   {milling:7.2}");
    }
    Ok(())
}

/// Index of a quantity among the recorded ones, which are in the order of the table.
fn index_of(name: &str) -> usize {
    let mut names = QUANTITIES.iter().map(|quantity| quantity.name);
    names
        .position(|known| known == name)
        .expect("a name of the table")
}

/// Means of the magnitudes over the second half of four minutes, for 60 rods that never stop.
fn means(boat_shape: f64) -> Result<[f64; 3]> {
    let parameters = FlockParameters {
        n_boats: 60,
        // An inner radius of 0 is a dish.
        pool: Pool {
            outer_radius_cm: 150.0,
            inner_radius_cm: 0.0,
        },
        boat_radius_cm: 4.0,
        boat_shape,
        gyration_radius_cm: 4.0 * (0.5 + boat_shape / 3.0),
        // The motor never stops and never reverses.
        nop1_s: 0.0,
        bw_s: 0.0,
        nop2_s: 0.0,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut flock = Flock::new(parameters, 1)?;
    flock.advance(120.0, None)?;
    let samples = 240;
    let mut sums = [0.0; 3];
    for _ in 0..samples {
        flock.advance(0.5, None)?;
        let recorded = flock.recorded(true)?;
        for (sum, name) in sums.iter_mut().zip(NAMES) {
            *sum += recorded[index_of(name)].abs() / f64::from(samples);
        }
    }
    Ok(sums)
}
