//! Parameters out of range are refused by name, at the one gate through which they enter a flock.
//!
//! On paper: Tables 1 and 3 are accepted, each of their fields out of range is refused by its name.

use crate::support::{annulus, changed, refused_field, table_3};
use flockenv::parameters::{Field, Kind, Noise, Pool, Preset, Scheme, Solver, Target, Value};
use flockenv::{Flock, FlockError, FlockParameters};

#[test]
fn presets_are_the_tables() {
    for preset in [Preset::Simulation, Preset::Paper] {
        let p = FlockParameters::preset(preset);
        assert_eq!((p.boat_radius_cm, p.half_length_cm()), (5.0, 2.5));
        assert_eq!(p.gyration_radius_cm, 4.74);
        assert_eq!((p.speed_cm_s, p.reverse_speed_cm_s), (15.0, 15.0));
        assert_eq!([p.c0, p.c1, p.c2, p.c3, p.c4], [1.0, 1.0, 0.1, 1.0, 0.1]);
        assert_eq!([p.fw_s, p.nop1_s, p.nop2_s], [2.0, 1.0, 1.0]);
        assert_eq!((p.n_boats, p.n_leaders), (20, 0));
        assert_eq!(p.pool.name(), Some("wide"));
        assert!(p.leaders_reverse);
    }
    let (simulation, paper) = (table_3(), FlockParameters::preset(Preset::Paper));
    assert_eq!((simulation.bw_s, paper.bw_s), (0.3, 0.6));
    assert_eq!(
        (simulation.scheme, simulation.noise_scheme),
        (Scheme::Leapfrog, Noise::White)
    );
    assert_eq!(
        (paper.scheme, paper.noise_scheme),
        (Scheme::Paper, Noise::PerStep)
    );
    let radii = |name| Pool::named(name).map(|p| (p.outer_radius_cm, p.inner_radius_cm));
    assert_eq!(radii("narrow"), Ok((90.0, 48.5)));
    assert_eq!(radii("wide"), Ok((180.0, 97.0)));
}

#[test]
fn the_experiment_is_narrow() {
    let p = FlockParameters::preset(Preset::Experiment);
    assert_eq!((p.n_boats, p.n_leaders, p.leaders_reverse), (27, 0, false));
    assert_eq!(p.pool.name(), Some("narrow"));
    assert!((10.0..=20.0).contains(&p.speed_cm_s));
    assert_eq!([p.fw_s, p.nop1_s, p.nop2_s], [2.0, 1.0, 1.0]);
    assert_eq!((p.scheme, p.noise_scheme), (Scheme::Leapfrog, Noise::White));
    // Table 1: backing boats turn at 1 ± 0.2 rad/s; where that rate is steady,
    // c1·w² = c3·v0·c0²/(c0² + w²).
    let lag = |w: f64| p.c0 * p.c0 / (p.c0 * p.c0 + w * w);
    let lagged = |w: f64| p.c3 * p.reverse_speed_cm_s * lag(w) - p.c1 * w * w;
    assert!(lagged(0.8) > 0.0 && lagged(1.2) < 0.0);
}

#[test]
fn every_preset_is_accepted() {
    for preset in Preset::ALL.iter().copied() {
        assert_eq!(FlockParameters::preset(preset).check(), Ok(()));
        assert_eq!(preset.source("bw"), None);
    }
}

/// Table 3's parameters with another value of a real field.
fn with(name: &str, number: f64) -> FlockParameters {
    let mut parameters = table_3();
    let mut fields = FlockParameters::FIELDS.iter();
    let field = fields.find(|field| field.name == name);
    let set = field.expect("a field of that name").set;
    set(&mut parameters, &Value::Real(number)).expect("a value of the field's kind");
    parameters
}

#[test]
fn every_number_out_of_range_is_refused_by_name() {
    let is_real = |field: &&Field<FlockParameters>| matches!(field.kind, Kind::Real);
    // An infinite tolerance has a meaning.
    let is_bounded = |field: &&Field<FlockParameters>| field.name != "tolerance_cm";
    let fields = FlockParameters::FIELDS
        .iter()
        .filter(is_real)
        .filter(is_bounded);
    assert!(fields.clone().count() >= 20);
    for field in fields {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -2.0, 1e300] {
            let p = with(field.name, value);
            assert_eq!(refused_field(p.check()), field.name, "{value}");
            // The same at the gate.
            assert!(Flock::new(p, 1).is_err());
        }
    }
    for name in ["boat_radius_cm", "gyration_radius_cm", "dt_s"] {
        assert_eq!(refused_field(with(name, 0.0).check()), name, "zero");
    }
}

#[test]
fn a_tolerance_that_numbers_cannot_hold_is_refused_with_what_they_can() {
    let refusal = |tolerance_cm, outer_radius_cm| {
        let p = changed(table_3(), |p| {
            (p.tolerance_cm, p.pool.outer_radius_cm) = (tolerance_cm, outer_radius_cm);
        });
        p.check().err().map(|error| error.to_string())
    };
    for tolerance in [
        0.0,
        -0.0,
        f64::NAN,
        -1e-4,
        f64::NEG_INFINITY,
        9e-11,
        f64::MIN_POSITIVE,
    ] {
        let refused = refusal(tolerance, 180.0).expect("refused");
        assert!(refused.starts_with("tolerance_cm = "), "{refused}");
        assert!(refused.contains("1e-10 cm or more"), "{refused}");
    }
    for tolerance in [1e-10, 1e-9, 1e-4, 1.0, f64::INFINITY] {
        assert_eq!(refusal(tolerance, 180.0), None, "{tolerance}");
    }
    // The last digit of a coordinate of 1e6 cm is 1e-10 cm; open water has no largest one.
    let refused = refusal(1e-9, 1e6).expect("refused");
    assert!(refused.contains("3.55"), "{refused}");
    assert_eq!(refusal(1e-8, 1e6), None);
    assert_eq!(refusal(1e-10, f64::INFINITY), None);
}

#[test]
fn counts_pools_and_times_out_of_range_are_refused() {
    let check =
        |change: fn(&mut FlockParameters)| refused_field(changed(table_3(), change).check());
    assert_eq!(check(|p| p.n_boats = 0), "n_boats");
    assert_eq!(check(|p| p.n_boats = usize::MAX), "n_boats");
    assert_eq!(check(|p| p.n_leaders = 21), "n_leaders");
    for (outer_radius_cm, inner_radius_cm) in [
        (90.0, 90.0),
        (48.5, 90.0),
        (0.0, 0.0),
        (-1.0, 0.0),
        (90.0, -1.0),
        (f64::NAN, 0.0),
        (90.0, f64::NAN),
        (f64::INFINITY, f64::INFINITY),
        (f64::NEG_INFINITY, 0.0),
    ] {
        let pool = annulus(outer_radius_cm, inner_radius_cm);
        let p = FlockParameters { pool, ..table_3() };
        assert_eq!(refused_field(p.check()), "pool", "{pool:?}");
    }
    // One phase may last no time, the cycle may not.
    let no_cycle =
        |p: &mut FlockParameters| (p.fw_s, p.nop1_s, p.bw_s, p.nop2_s) = (0.0, 0.0, 0.0, 0.0);
    assert!(check(no_cycle).contains("fw_s"));
    // Each scheme has its longest substep.
    for (scheme, good, bad) in [
        (Scheme::Leapfrog, 1.0, 1.001),
        (Scheme::Moreau, 0.1, 0.101),
        (Scheme::Paper, 0.1, 0.101),
    ] {
        let with = |dt_s| FlockParameters {
            scheme,
            dt_s,
            ..table_3()
        };
        assert_eq!(with(good).check(), Ok(()));
        assert_eq!(refused_field(with(bad).check()), "dt_s");
        assert_eq!(refused_field(with(-0.01).check()), "dt_s");
    }
}

#[test]
fn names_are_parsed_and_unknown_ones_refused_with_what_there_is() {
    for scheme in Scheme::ALL.iter().copied() {
        assert_eq!(scheme.name().parse(), Ok(scheme));
    }
    let message = |error: FlockError| error.to_string();
    let scheme = "euler".parse::<Scheme>().map_err(message);
    assert!(scheme.is_err_and(|m| m.contains("scheme") && m.contains("leapfrog")));
    let noise = "pink".parse::<Noise>().map_err(message);
    assert!(noise.is_err_and(|m| m.contains("noise") && m.contains("per-step")));
    let solver = "".parse::<Solver>().map_err(message);
    assert!(solver.is_err_and(|m| m.contains("solver") && m.contains("block-pivoting")));
    let target = "CW".parse::<Target>().map_err(message);
    assert!(target.is_err_and(|m| m.contains("target") && m.contains("ccw")));
    let pool = Pool::named("bathtub").map_err(message);
    assert!(pool.is_err_and(|m| m.contains("pool") && m.contains("narrow")));
}
