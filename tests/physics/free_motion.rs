//! Free motion, eqs (8) and (9): ẍ = c0·(v0·u − ẋ), α̈ = −c1·α̇³ + (c2·s − c3·α̇)(u·ẋ).
//!
//! On paper: a boat that holds its heading reaches v = v0·(1 − exp(−c0·t)), x = v0·(t − (1 − exp(−c0·t))/c0).
//! Otherwise: a Runge–Kutta solution of order 4 with steps of 0.1 ms.

use crate::reference::{equations_of_motion, runge_kutta};
use crate::support::{
    SCHEMES, changed, driven, flock_of, inert, take_substeps, time_of_velocities,
};
use flockenv::FlockParameters;
use flockenv::parameters::Scheme;

/// Distance run from rest, the speed then and its own time.
fn run_from_rest(scheme: Scheme, dt: f64, duration: f64) -> (f64, f64, f64) {
    let p = changed(driven(scheme), |p| p.dt_s = dt);
    let heading: f64 = 0.7;
    let mut flock = flock_of(&p, &[([0.0, 0.0, heading], [0.0; 3])]);
    flock.advance(duration, None).expect("finite motion");
    let speed = flock.velocities()[0].linear.norm();
    let time = time_of_velocities(scheme, duration, dt);
    let position = flock.poses()[0].position;
    assert!((position.y.atan2(position.x) - heading).abs() < 1e-12);
    (position.norm(), speed, time)
}

#[test]
fn speed_relaxes_exponentially() {
    // One Crank–Nicolson step of length dt errs by (c0·dt)³/12 of the speed, one Euler step by
    // (c0·dt)²/2; the starting half step of leapfrog adds (c0·dt)²/8 once. Summed over 3 s these stay
    // below v0·t·(c0·dt)²/4 and v0·t·c0·dt.
    for scheme in SCHEMES {
        for dt in [0.02, 0.01, 0.005] {
            let (run, speed, time) = run_from_rest(scheme, dt, 3.0);
            let exact_run = 15.0 * (3.0 - (1.0 - (-3.0_f64).exp()));
            let exact_speed = 15.0 * (1.0 - (-time).exp());
            let bound = match scheme {
                Scheme::Leapfrog => 15.0 * 3.0 * dt * dt / 4.0,
                Scheme::Moreau | Scheme::Paper => 15.0 * 3.0 * dt,
            };
            assert!((run - exact_run).abs() < bound, "{scheme:?} {dt}");
            assert!((speed - exact_speed).abs() < bound, "{scheme:?} {dt}");
        }
    }
}

#[test]
fn an_engine_switched_off_lets_the_speed_decay() {
    for (scheme, factor) in [
        // The first kick of leapfrog lasts half a substep.
        (
            Scheme::Leapfrog,
            (0.995_f64 / 1.005) * (0.99_f64 / 1.01).powi(99),
        ),
        (Scheme::Moreau, 0.98_f64.powi(100)),
        (Scheme::Paper, 0.98_f64.powi(100)),
    ] {
        let p = changed(driven(scheme), |p| p.speed_cm_s = 0.0);
        let mut flock = flock_of(&p, &[([0.0; 3], [9.0, -4.0, 0.0])]);
        take_substeps(&mut flock, 100);
        let linear = flock.velocities()[0].linear;
        assert!((linear.x - 9.0 * factor).abs() < 1e-12, "{scheme:?}");
        assert!((linear.y + 4.0 * factor).abs() < 1e-12, "{scheme:?}");
    }
}

#[test]
fn without_forces_motion_is_uniform() {
    for scheme in SCHEMES {
        let mut flock = flock_of(&inert(scheme), &[([1.0, 2.0, 0.5], [3.0, -1.0, 0.25])]);
        flock.advance(7.03, None).expect("finite motion");
        let pose = flock.poses()[0];
        assert!((pose.position.x - (1.0 + 7.03 * 3.0)).abs() < 1e-11);
        assert!((pose.position.y - (2.0 - 7.03)).abs() < 1e-11);
        assert!((pose.heading - (0.5 + 7.03 * 0.25)).abs() < 1e-11);
    }
}

/// Two whole cycles of a leader with a held rudder; x, y and heading at the end.
fn two_cycles(scheme: Scheme, dt: f64, p: &FlockParameters, rudder: f64) -> [f64; 3] {
    let p = FlockParameters {
        n_leaders: 1,
        scheme,
        dt_s: dt,
        ..p.clone()
    };
    let mut flock = flock_of(&p, &[([3.0, -2.0, 0.4], [2.0, 1.0, 0.3])]);
    flock
        .advance(2.0 * cycle_s(&p), Some(&[rudder]))
        .expect("finite motion");
    let pose = flock.poses()[0];
    [pose.position.x, pose.position.y, pose.heading]
}

fn cycle_s(p: &FlockParameters) -> f64 {
    p.fw_s + p.nop1_s + p.bw_s + p.nop2_s
}

/// The same by Runge–Kutta, phase by phase.
fn exact_two_cycles(p: &FlockParameters, rudder: f64) -> [f64; 3] {
    let mut state = [3.0, -2.0, 0.4, 2.0, 1.0, 0.3];
    for _ in 0..2 {
        for (length, speed) in [
            (p.fw_s, p.speed_cm_s),
            (p.nop1_s, 0.0),
            (p.bw_s, -p.reverse_speed_cm_s),
            (p.nop2_s, 0.0),
        ] {
            let steps = (length * 1e4).round() as usize;
            if steps == 0 {
                continue;
            }
            state = runge_kutta(state, (0.0, length), steps, |y, _| {
                equations_of_motion(p, speed, rudder, y)
            });
        }
    }
    [state[0], state[1], state[2]]
}

fn largest_error(found: [f64; 3], exact: [f64; 3]) -> f64 {
    (0..3)
        .map(|i| (found[i] - exact[i]).abs())
        .fold(0.0, f64::max)
}

/// Orders of convergence observed between dt, dt/2 and dt/4.
fn observed_orders(scheme: Scheme, dt: f64, p: &FlockParameters) -> Vec<f64> {
    let exact = exact_two_cycles(p, 0.7);
    let errors: Vec<f64> = [dt, 0.5 * dt, 0.25 * dt]
        .iter()
        .map(|&dt| largest_error(two_cycles(scheme, dt, p, 0.7), exact))
        .collect();
    errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect()
}

/// Cycles of [2 1 bw 1] s.
fn cycles(bw_s: f64) -> FlockParameters {
    FlockParameters {
        fw_s: 2.0,
        nop1_s: 1.0,
        bw_s,
        nop2_s: 1.0,
        ..driven(Scheme::Leapfrog)
    }
}

#[test]
fn two_cycles_converge_to_the_exact_solution_with_the_scheme_s_order() {
    let p = cycles(0.6);
    // Orders are asymptotic: at these dt the next term still moves them by a tenth or two.
    for (scheme, order, slack) in [
        (Scheme::Leapfrog, 2.0, 0.15),
        (Scheme::Moreau, 1.0, 0.2),
        (Scheme::Paper, 1.0, 0.2),
    ] {
        for observed in observed_orders(scheme, 0.01, &p) {
            assert!((observed - order).abs() < slack, "{scheme:?}: {observed}");
        }
    }
}

#[test]
fn switches_off_the_grid_of_substeps_keep_the_order() {
    // None of these durations is a multiple of any dt used.
    let p = FlockParameters {
        fw_s: 1.013_7,
        nop1_s: 0.507_3,
        bw_s: 0.431_9,
        nop2_s: 0.0,
        ..driven(Scheme::Leapfrog)
    };
    // The leftover substeps have other lengths at every dt, so single ratios scatter; two halvings of
    // dt must gain 2·order.
    for (scheme, least) in [(Scheme::Leapfrog, 3.4), (Scheme::Moreau, 1.6)] {
        let gained: f64 = observed_orders(scheme, 0.01, &p).iter().sum();
        assert!(gained > least, "{scheme:?}: {gained}");
    }
}

#[test]
fn leapfrog_is_exact_to_a_hundredth_of_a_millimeter_a_second() {
    // dt = 0.01: the second-order error constant of a cycle with backing is of order 10 cm/s², which
    // gives 1e-3 cm; the first-order schemes are a hundred times worse.
    let p = cycles(0.3);
    let exact = exact_two_cycles(&p, 0.7);
    let error = |scheme| largest_error(two_cycles(scheme, 0.01, &p, 0.7), exact);
    let (leapfrog, moreau) = (error(Scheme::Leapfrog), error(Scheme::Moreau));
    assert!(leapfrog < 8.6e-3, "{leapfrog}");
    assert!(moreau > 10.0 * leapfrog, "{moreau}");
}

#[test]
fn no_spin_grows_at_the_longest_step() {
    // Turning on the spot, engine off, obeys α̈ = −c1·α̇³: α̇ = α̇0/sqrt(1 + 2·c1·α̇0²·t) only ever shrinks.
    for scheme in SCHEMES {
        for spin in [0.5, 4.0, 6.0, 50.0, 1e4] {
            let p = FlockParameters {
                dt_s: scheme.longest_dt_s().min(0.1),
                speed_cm_s: 0.0,
                reverse_speed_cm_s: 0.0,
                ..driven(scheme)
            };
            let mut flock = flock_of(&p, &[([0.0; 3], [0.0, 0.0, spin])]);
            let mut before = spin;
            for _ in 0..50 {
                take_substeps(&mut flock, 1);
                let now = flock.velocities()[0].angular;
                assert!(
                    (0.0..=before).contains(&now),
                    "{scheme:?}: {before} to {now}"
                );
                before = now;
            }
            let exact = spin / (1.0 + 2.0 * p.c1 * spin * spin * flock.time_s()).sqrt();
            assert!(
                before <= 1.2 * exact,
                "{scheme:?} from {spin}: {before}, exactly {exact}"
            );
        }
    }
}

#[test]
fn a_rudder_that_is_put_over_keeps_the_order_of_leapfrog() {
    // A kick across the change has half of each rudder: with the later one alone, errors are of first order.
    let end = |dt_s: f64| {
        let p = FlockParameters {
            n_leaders: 1,
            dt_s,
            ..driven(Scheme::Leapfrog)
        };
        let mut flock = flock_of(&p, &[([0.0; 3], [15.0, 0.0, 0.0])]);
        for rudder in [0.8, -0.8, 0.2, 1.0] {
            flock.advance(0.4, Some(&[rudder])).expect("finite motion");
        }
        flock.poses()[0].heading
    };
    let [coarse, fine, finer] = [0.02, 0.01, 0.005].map(end);
    let order = ((coarse - fine) / (fine - finer)).abs().log2();
    assert!((order - 2.0).abs() < 0.25, "{order}");
}
