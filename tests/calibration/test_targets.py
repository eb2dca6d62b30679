"""Law: calibration targets are computed from runs as their statements say."""

import math

import numpy as np
import pytest

from flockenv import FlockParameters
from flockenv.calibration.flock_runs import (
    JUDGED,
    QUANTITIES,
    SEARCHED,
    Cell,
    FlockRuns,
    run_flock,
    run_flocks,
    single_boat,
)
from flockenv.calibration.targets import GROUPS, SEARCHED_TARGETS, TARGETS, measure, misfits
from flockenv.runs.protocols.target_switching import PERIOD_S

EXPERIMENT = FlockParameters.preset("experiment-2026").replace(dt_s=0.1, relinearizations=1)
BY_KEY = {target.key: target for target in TARGETS}
BOAT = {
    "forward_cm_s": 15.0,
    "forward_turn_rad_s": 0.0,
    "backing_turn_rad_s": 1.0,
    "backing_over_forward": 0.3,
}


def runs_with(psi_o, design=JUDGED, **quantities):
    """Return runs of two repetitions whose quantities are functions of (leaders, bw)."""
    given = {
        "psi_o": psi_o,
        "rotation": lambda k, bw_s: 0.5,
        "ordered": lambda k, bw_s: 1.0,
        "jammed": lambda k, bw_s: 0.1,
        "off_tangent": lambda k, bw_s: 0.1,
        "along_target": lambda k, bw_s: 1.0,
        "c_v": lambda k, bw_s: 20.0 if bw_s < 0.5 else 100.0,
        "ordering_s": lambda k, bw_s: 200.0 - 30.0 * bw_s,
        "following": lambda k, bw_s: 0.8,
    } | quantities
    rows = [[given[name](cell.leaders, cell.bw_s) for name in QUANTITIES] for cell in design.cells]
    return FlockRuns(design, np.repeat(np.array(rows)[:, None], 2, axis=1))


def ideal(k, bw_s):
    middle = 1.4 if k == 0 else 2.0
    if bw_s == 1.8:
        return 0.4 + 0.1 * k
    return 0.56 if bw_s == middle else 0.95 if bw_s < middle else 0.2


def test_a_boat_alone_does_what_the_equations_say():
    p = EXPERIMENT.replace(c4=1e-4, dt_s=0.02, relinearizations=0)
    boat = single_boat(p)
    assert boat["forward_cm_s"] == pytest.approx(15.0, abs=1e-3)
    assert boat["forward_turn_rad_s"] == pytest.approx(0.0, abs=1e-3)
    # c1·w² = c3·v·c0²/(c0² + w²), see docs/model.md.
    push = p.c3 * p.reverse_speed_cm_s / p.c1
    turn = math.sqrt((math.sqrt(1 + 4 * push) - 1) / 2)
    assert boat["backing_turn_rad_s"] == pytest.approx(turn, abs=2e-3)
    # Periodic: v = 15(1 − e^−2) + v_back e^−(1+1.4+1+2) …; without turning less than these.
    assert 0.0 < boat["backing_over_forward"] < p.reverse_speed_cm_s / 15
    # c1·w³ + c3·w·v = c2·s·v, and v lags by c0²/(c0² + w²): the small root is c2·s/c3.
    biased = single_boat(p.replace(turning_bias=1e-3))
    assert biased["forward_turn_rad_s"] == pytest.approx(1e-3 * p.c2 / p.c3, rel=0.1)
    # An average boat, in still water.
    assert single_boat(p.replace(speed_spread_cm_s=5.0, current_gain=0.3)) == boat


def test_order_is_lost_where_the_curve_falls_through_the_middle():
    falling = runs_with(lambda k, bw_s: 0.96 - 0.4 * bw_s if k == 0 else 0.96 - 0.2 * bw_s)
    assert falling.critical_bw_s(0) == pytest.approx(1.0)
    assert falling.critical_bw_s(3) == pytest.approx(2.0)
    # A dip below the middle that recovers is not the end of order.
    dip = runs_with(lambda k, bw_s: 0.3 if bw_s in (0.6, 2.2, 2.6) else 0.82)
    assert 1.8 < dip.critical_bw_s(0) < 2.2


def test_curves_that_never_cross_are_still_ranked():
    at = [runs_with(lambda k, bw_s, level=level: level).critical_bw_s(0) for level in (0.2, 0.4)]
    assert at[0] < at[1] < 0.4
    at = [runs_with(lambda k, bw_s, level=level: level).critical_bw_s(0) for level in (0.7, 0.9)]
    assert 2.2 < at[0] < at[1]


def test_an_ideal_experiment_meets_every_target():
    values = measure(BOAT, runs_with(ideal))
    assert [key for key, value in values.items() if not BY_KEY[key].is_in_range(value)] == []
    assert misfits(values) == pytest.approx(np.zeros(len(GROUPS)), abs=1e-12)
    assert values["leaders_slope"] == pytest.approx(0.1)
    assert values["leaders_gain"] == pytest.approx(0.3)
    assert values["velocity_dip"] == pytest.approx(0.2)
    assert values["ordering_slope_0"] == pytest.approx(-30.0)
    assert values["ordering_slope_3"] == pytest.approx(-30.0)
    assert values["following"] == pytest.approx(0.8)


def test_the_runs_of_a_trial_determine_what_is_searched():
    values = measure(BOAT, runs_with(ideal, SEARCHED))
    searched = {target.key for target in SEARCHED_TARGETS}
    undefined = {key for key, value in values.items() if math.isnan(value)}
    assert undefined == {key for key in BY_KEY if key not in searched and key not in BOAT}


def test_misses_are_counted_in_tolerances_by_group():
    values = measure(BOAT, runs_with(ideal))
    group = sum(target.group == "no leaders" for target in TARGETS)
    assert misfits({**values, "critical_bw_0": 1.5})[0] == pytest.approx(1.0 / group)
    # Beyond two tolerances the penalty grows in proportion.
    assert misfits({**values, "critical_bw_0": 1.8})[0] == pytest.approx(12.0 / group)
    assert misfits({**values, "off_tangent": math.nan})[0] == pytest.approx(8.0 / group)
    arrays = {key: np.array([value, value]) for key, value in values.items()}
    arrays["jamming"] = np.array([0.1, 0.2])
    jamming = sum(target.group == "jamming" for target in TARGETS)
    assert misfits(arrays)[:, GROUPS.index("jamming")] == pytest.approx([0.0, 1.0 / jamming])


def test_a_target_is_met_inside_its_range_only():
    assert len(BY_KEY) == len(TARGETS)
    turn = BY_KEY["backing_turn_rad_s"]
    assert [turn.is_in_range(value) for value in (0.79, 0.8, 1.2, 1.21)] == [
        False,
        True,
        True,
        False,
    ]
    assert not BY_KEY["off_tangent"].is_in_range(math.nan)
    # One-sided: the residual is 0 inside.
    assert BY_KEY["high_noise_0"].residual(0.1) == 0.0
    assert BY_KEY["high_noise_0"].residual(0.4) == pytest.approx(1.0)


def guided(slope, scatter):
    """Return 24 repetitions of the runs of figure 12: a line and normal scatter."""
    rng = np.random.default_rng(7)
    values = runs_with(ideal).values.repeat(12, axis=1)
    for place, cell in enumerate(JUDGED.cells):
        line = 0.4 + slope * cell.leaders
        values[place, :, 0] = line + scatter * rng.standard_normal(values.shape[1])
    return FlockRuns(JUDGED, values)


def test_the_line_of_figure_12_passes_as_often_as_its_noncentral_f_says():
    """The paper's F = 13.5 is a slope of 0.58 deviations: 20 runs reach p = 0.01 in 3 of 4 sets."""
    test = BY_KEY["leaders_test"].value
    assert test(guided(0.1, 0.01)) == 1.0
    assert test(guided(-0.1, 0.01)) == 0.0
    assert test(guided(0.0, 0.1)) < 0.1
    assert 0.4 < test(guided(0.058, 0.1)) < 0.98


def test_a_flock_that_never_moves_has_no_dip_and_no_line_of_one_level():
    stationary = runs_with(ideal, c_v=lambda k, bw_s: 5.0)
    assert math.isnan(BY_KEY["velocity_dip"].value(stationary))
    rare = runs_with(ideal, ordering_s=lambda k, bw_s: 100.0 if bw_s == 1.0 else math.nan)
    assert math.isnan(rare.ordering_slope(0))
    none = runs_with(ideal, ordered=lambda k, bw_s: 0.0)
    assert math.isnan(BY_KEY["off_tangent"].value(none))


def test_a_run_is_measured_by_its_states():
    flock = EXPERIMENT
    measured = dict(zip(QUANTITIES, run_flock(flock, Cell(3, 1.4), 5), strict=True))
    assert 0.2 < measured["psi_o"] <= 1.0
    assert abs(measured["rotation"]) <= measured["psi_o"]
    assert 0.0 < measured["ordered"] <= 1.0 - measured["jammed"]
    assert 0.0 < measured["off_tangent"] < measured["ordered"] * math.pi / 4
    assert measured["along_target"] <= measured["ordered"]
    assert -225.0 <= measured["c_v"] <= 225.0
    assert math.isnan(measured["following"])


def test_leaders_that_alternate_are_followed_towards_what_they_steer_to():
    """With 26 leaders of 27 the one normal boat is pushed along, either way."""
    cell = Cell(24, 0.2, 2 * PERIOD_S, alternates=True)
    measured = dict(zip(QUANTITIES, run_flock(EXPERIMENT, cell, 3), strict=True))
    assert 0.3 < measured["following"] <= 1.0


def test_each_run_of_a_design_has_a_seed_of_its_own():
    width = len(SEARCHED.cells)
    rows = SEARCHED.seeds(range(100, 100 + 2 * width))
    assert [list(row) for row in rows] == [
        list(range(100, 100 + width)),
        list(range(100 + width, 100 + 2 * width)),
    ]
    assert pytest.approx(4 / 3) == SEARCHED.flock_hours
    assert len({cell.name for cell in JUDGED.cells}) == len(JUDGED.cells)


def test_jobs_change_no_bit(monkeypatch):
    flock = EXPERIMENT.replace(n_boats=5)
    runs = [run_flocks(flock, SEARCHED, range(len(SEARCHED.cells)), jobs) for jobs in (1, 3)]
    assert np.array_equal(runs[0].values, runs[1].values, equal_nan=True)
