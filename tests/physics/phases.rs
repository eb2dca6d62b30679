//! The phases fw, nop, bw, nop follow each other on an exact clock of 1 ns ticks; a substep ends on
//! every switch and on every control step, and never straddles one.
//!
//! On paper: [2 1 0.3 1] s repeat after 4.3 s; the analysis window is the second half of fw and the
//! first half of the drift after it: [1, 2.5) s.

use crate::support::{SCHEMES, driven, flock_of};
use flockenv::FlockParameters;
use flockenv::clock::ticks;
use flockenv::integrator::{Phase, PhaseSchedule, sampled_analysis_window};
use flockenv::parameters::{Preset, Scheme};

fn cycle(durations: [f64; 4], scheme: Scheme) -> FlockParameters {
    let [fw_s, nop1_s, bw_s, nop2_s] = durations;
    FlockParameters {
        fw_s,
        nop1_s,
        bw_s,
        nop2_s,
        ..driven(scheme)
    }
}

#[test]
fn phases_follow_each_other() {
    let schedule = PhaseSchedule::new(&FlockParameters::preset(Preset::Simulation));
    assert_eq!(schedule.cycle(), 4_300_000_000);
    let phase_at = |s: f64| schedule.at(ticks(s)).phase;
    for lap in [0.0, 4.3, 43.0, 4.3e6] {
        assert_eq!(phase_at(lap), Phase::Forward);
        assert_eq!(phase_at(lap + 1.999_999_999), Phase::Forward);
        assert_eq!(phase_at(lap + 2.0), Phase::DriftAfterForward);
        assert_eq!(phase_at(lap + 3.0), Phase::Backward);
        assert_eq!(phase_at(lap + 3.299_999_999), Phase::Backward);
        assert_eq!(phase_at(lap + 3.3), Phase::DriftAfterBackward);
    }
    let moment = schedule.at(ticks(3.1));
    assert_eq!((moment.elapsed, moment.left), (100_000_000, 200_000_000));
}

#[test]
fn phases_of_no_length_do_not_occur() {
    for zero in 0..4 {
        let mut durations = [0.4, 0.3, 0.2, 0.1];
        durations[zero] = 0.0;
        let schedule = PhaseSchedule::new(&cycle(durations, Scheme::Leapfrog));
        let mut time = 0;
        let mut seen = [0_u64; 4];
        for _ in 0..6 {
            let moment = schedule.at(time);
            assert_eq!(moment.elapsed, 0);
            assert!(moment.left > 0);
            seen[moment.phase.index()] += moment.left;
            time += moment.left;
        }
        // Two cycles of three phases.
        let expected = durations.map(|s| 2 * ticks(s));
        assert_eq!(seen, expected);
    }
}

#[test]
fn the_analysis_window() {
    let schedule = PhaseSchedule::new(&FlockParameters::preset(Preset::Simulation));
    let inside = |s: f64| schedule.in_analysis_window(ticks(s));
    for lap in [0.0, 4.3, 8.6] {
        for (offset, expected) in [
            (0.0, false),
            (0.999_999_999, false),
            (1.0, true),
            (1.999_999_999, true),
            (2.0, true),
            (2.499_999_999, true),
            (2.5, false),
            (3.1, false),
            (4.0, false),
        ] {
            assert_eq!(inside(lap + offset), expected, "{offset}");
        }
    }
    // Engines always forward: the second half of each cycle.
    let schedule = PhaseSchedule::new(&cycle([1.0, 0.0, 0.0, 0.0], Scheme::Leapfrog));
    let inside = (0..1000).filter(|&i| schedule.in_analysis_window(ticks(0.001 * f64::from(i))));
    assert_eq!(inside.count(), 500);
}

#[test]
fn the_analysis_window_of_sampled_phases() {
    use Phase::{Backward, DriftAfterForward, Forward};
    // fw from 0 to 4 s, the drift from 4 to 6 s, bw to the last time.
    let drift_and_back = [DriftAfterForward, DriftAfterForward, Backward, Backward];
    let phases = [[Forward; 4], drift_and_back].concat();
    let times_s: Vec<f64> = (0..8).map(f64::from).collect();
    let analyzed = sampled_analysis_window(&times_s, &phases);
    let expected = [false, false, true, true, true, false, false, false];
    assert_eq!(analyzed, expected);
    assert!(sampled_analysis_window(&[], &[]).is_empty());
    // A phase lasts until the next one's first sample, not its own last: fw to 4 s, with its middle at 2 s.
    let irregular = sampled_analysis_window(&[0.0, 1.75, 3.0, 4.0, 5.0], &phases[1..6]);
    assert_eq!(irregular, [false, false, true, true, false]);

    // Samples of a flock's own schedule, taken where every phase has a middle.
    let schedule = PhaseSchedule::new(&FlockParameters::preset(Preset::Simulation));
    let times_s: Vec<f64> = (0..430).map(|k| f64::from(k) * 0.05).collect();
    let phase_at = |s: &f64| schedule.at(ticks(*s)).phase;
    let phases: Vec<_> = times_s.iter().map(phase_at).collect();
    let analyzed = sampled_analysis_window(&times_s, &phases);
    for (time, found) in times_s.iter().zip(analyzed) {
        // Times in s are rounded, which decides at the very middle of a phase.
        let moment = schedule.at(ticks(*time));
        if moment.elapsed != moment.left {
            let expected = schedule.in_analysis_window(ticks(*time));
            assert_eq!(found, expected, "{time} s");
        }
    }
}

#[test]
fn substeps_end_on_switches_and_control_steps_without_slivers() {
    for scheme in SCHEMES {
        // On the grid: exactly duration/dt substeps, although 0.02 and 0.1 are no binary numbers.
        let p = cycle([2.0, 1.0, 0.3, 1.0], scheme);
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        for _ in 0..430 {
            flock.advance(0.1, None).expect("finite motion");
        }
        assert_eq!(flock.time(), 43_000_000_000);
        assert_eq!(flock.statistics().substeps, 2150);
        // Off the grid of 0.02 s: fw ends at 0.05, nop1 at 0.11, bw at 0.17, nop2 at 0.2. Substeps end at
        // .02 .04 [.05] .06 .08 .10 [.11] .12 .14 .16 [.17] .18 .20.
        let p = cycle([0.05, 0.06, 0.06, 0.03], scheme);
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        flock.advance(0.2, None).expect("finite motion");
        assert_eq!(flock.statistics().substeps, 13);
        // A control step at 0.055 cuts one more.
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        flock.advance(0.055, None).expect("finite motion");
        assert_eq!(flock.statistics().substeps, 4);
        flock.advance(0.145, None).expect("finite motion");
        assert_eq!(flock.statistics().substeps, 14);
        assert_eq!(flock.time(), 200_000_000);
    }
}

#[test]
fn no_time_takes_no_substep() {
    for scheme in SCHEMES {
        let mut flock = flock_of(&driven(scheme), &[([0.0; 3], [1.0, 0.0, 0.0])]);
        flock.advance(0.0, None).expect("nothing to do");
        flock.advance(1e-12, None).expect("less than a tick");
        assert_eq!(flock.statistics().substeps, 0);
        assert_eq!(flock.time(), 0);
    }
}

#[test]
fn each_phase_has_its_preferred_speed() {
    // From rest, over one short substep of each phase: v = ±c0·v0·dt, or nothing.
    for (durations, expected) in [
        ([1.0, 0.0, 0.0, 0.0], 15.0),
        ([0.0, 1.0, 0.0, 0.0], 0.0),
        ([0.0, 0.0, 1.0, 0.0], -7.0),
        ([0.0, 0.0, 0.0, 1.0], 0.0),
    ] {
        let p = FlockParameters {
            reverse_speed_cm_s: 7.0,
            dt_s: 1e-3,
            ..cycle(durations, Scheme::Moreau)
        };
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        flock.advance(1e-3, None).expect("finite motion");
        let speed = flock.velocities()[0].linear.x;
        assert!((speed - expected * 1e-3).abs() < 1e-15);
    }
}
