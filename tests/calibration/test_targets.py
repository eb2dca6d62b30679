"""Law: calibration targets are computed from runs as their statements say."""

import math

import numpy as np
import pytest

from flockenv import FlockParameters
from flockenv.calibration.targets import (
    NOISE_S,
    QUANTITIES,
    TARGETS,
    FlockRuns,
    loss,
    measure,
    run_flock,
    single_boat,
)

EXPERIMENT = FlockParameters.preset("experiment")


def runs_with(psi_o):
    """Return runs of two seeds whose mean Ψ_o is a function of (leaders, bw); all ordered, cw."""
    values = {}
    for k, levels in NOISE_S.items():
        array = np.ones((len(levels), 2, len(QUANTITIES)))
        array[:, :, QUANTITIES.index("off_tangent")] = 0.1
        array[:, :, QUANTITIES.index("jammed")] = 0.0
        array[:, :, 0] = np.array([[psi_o(k, bw_s)] for bw_s in levels])
        values[k] = array
    return FlockRuns(NOISE_S, values)


def test_a_boat_alone_does_what_the_equations_say():
    p = EXPERIMENT.replace(c4=1e-4)
    boat = single_boat(p)
    assert boat["forward_cm_s"] == pytest.approx(15.0, abs=1e-3)
    # c1·w² = c3·v·c0²/(c0² + w²), see docs/model.md.
    push = p.c3 * p.reverse_speed_cm_s / p.c1
    turn = math.sqrt((math.sqrt(1 + 4 * push) - 1) / 2)
    assert boat["backing_turn_rad_s"] == pytest.approx(turn, abs=2e-3)
    # Periodic: v = 15(1 − e^−2) + v_back e^−(1+1.4+1+2) …; without turning less than these.
    assert 0.0 < boat["backing_over_forward"] < p.reverse_speed_cm_s / 15


def test_order_is_lost_where_the_curve_falls_through_the_middle():
    falling = runs_with(lambda k, bw_s: 0.96 - 0.4 * bw_s if k == 0 else 0.96 - 0.2 * bw_s)
    assert falling.critical_bw_s(0) == pytest.approx(1.0)
    assert falling.critical_bw_s(3) == pytest.approx(2.0)
    # A dip below the middle that recovers is not the end of order.
    dip = runs_with(lambda k, bw_s: 0.3 if bw_s in (0.6, 2.2, 2.6) else 0.82)
    assert 1.8 < dip.critical_bw_s(0) < 2.2


def test_curves_that_never_cross_are_still_ranked():
    at = [runs_with(lambda k, bw_s, level=level: level).critical_bw_s(0) for level in (0.2, 0.4)]
    assert at[0] < at[1] < NOISE_S[0][0]
    at = [runs_with(lambda k, bw_s, level=level: level).critical_bw_s(0) for level in (0.7, 0.9)]
    assert NOISE_S[0][-1] < at[0] < at[1]


def test_an_ideal_experiment_has_no_loss_and_misses_are_counted_in_tolerances():
    def psi_o(k, bw_s):
        middle = 1.4 if k == 0 else 2.0
        return 0.56 if bw_s == middle else 0.95 if bw_s < middle else 0.2

    boat = {"forward_cm_s": 15.0, "backing_turn_rad_s": 1.0, "backing_over_forward": 0.3}
    values = measure(boat, runs_with(psi_o))
    assert loss(values) == pytest.approx(0.0, abs=1e-12)
    assert loss({**values, "backing_turn": 1.2}) == pytest.approx(1.0)
    # Beyond two tolerances the loss grows in proportion.
    assert loss({**values, "critical_bw_0": 1.8}) == pytest.approx(12.0)
    assert loss({**values, "critical_bw_0": 1.8}, only=["backing_turn"]) == 0.0
    assert loss({**values, "off_tangent": math.nan}) == pytest.approx(8.0)


def test_a_fact_is_met_inside_its_range_only():
    targets = {target.key: target for target in TARGETS}
    assert len(targets) == len(TARGETS)
    turn = targets["backing_turn"]
    assert [turn.is_in_range(value) for value in (0.79, 0.8, 1.2, 1.21)] == [
        False,
        True,
        True,
        False,
    ]
    assert not targets["off_tangent"].is_in_range(math.nan)
    # One-sided: the residual is 0 inside.
    assert targets["high_noise_0"].residual(0.1) == 0.0
    assert targets["high_noise_0"].residual(0.4) == pytest.approx(1.0)


def test_a_run_is_measured_by_its_states():
    measured = dict(zip(QUANTITIES, run_flock(EXPERIMENT.replace(n_leaders=3), 5), strict=True))
    assert 0.2 < measured["psi_o"] <= 1.0
    assert abs(measured["rotation"]) <= measured["psi_o"]
    assert 0.0 < measured["ordered"] <= 1.0 - measured["jammed"]
    assert 0.0 < measured["off_tangent"] < measured["ordered"] * math.pi / 4
    assert measured["along_target"] <= measured["ordered"]
