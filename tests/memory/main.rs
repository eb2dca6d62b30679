//! However long a flock runs, it holds no more memory than its boats and contacts need. A program of its own, since it
//! counts every allocation.

use flockenv::parameters::Pool;
use flockenv::{Flock, FlockParameters};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

#[test]
fn a_jam_whose_islands_change_holds_a_few_kilobytes_a_boat() {
    let n_boats = 400;
    let k = (n_boats as f64 / 50.0).sqrt();
    let parameters = FlockParameters {
        n_boats,
        bw_s: 0.0,
        pool: Pool {
            outer_radius_cm: k * Pool::NARROW.outer_radius_cm,
            inner_radius_cm: k * Pool::NARROW.inner_radius_cm,
        },
        ..FlockParameters::default()
    };
    let before = ALLOCATOR.current_usage();
    let mut flock = Flock::new(parameters, 1).expect("room");
    let mut held = [0.0; 12];
    for bytes_a_boat in &mut held {
        flock.advance(5.0, None).expect("finite motion");
        *bytes_a_boat = (ALLOCATOR.current_usage() - before) as f64 / n_boats as f64;
    }
    // A boat of a jam has one or two contacts, and each takes some 400 bytes of an island's rows and factor.
    assert!(held.iter().all(|&bytes| bytes < 6000.0), "{held:?}");
}
