"""Law: a number of the card follows from means over seeds, and is judged by its whole interval."""

import math
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

from studies.calibration.score_card import CARD
from studies.order import PHI_EDGES
from studies.section4.section4 import LEVELS_S

BY_NAME = {number.name: number for number in CARD}


def turning(angle: float) -> dict[str, object]:
    """A run whose flock has one direction in every frame."""
    counts = np.histogram([angle], PHI_EDGES)[0] * 1000
    ways = {"cw": float(angle > 0), "ccw": float(angle < 0)}
    return ways | {
        "phi_histogram": " ".join(map(str, counts)),
        "psi_o": 0.9,
        "psi_o_late": 0.95,
        "jammed": 0.1,
        "c_v": 100.0,
        "ordered_quarter_s": 60.0,
    }


@pytest.mark.parametrize(("arm", "angle"), [("cw", 1.5), ("ccw", -1.5)])
def test_a_led_flock_is_turned_so_that_its_leaders_go_clockwise(
    script: ModuleType, arm: str, angle: float
) -> None:
    runs = {bw_s: turning(angle) for bw_s in LEVELS_S}
    found = script.features_of(arm, runs)
    # Two of the 36 bins lie within 10° of a tangent, and one of them has all frames.
    assert found[f"{arm} tangent 1.4"] == pytest.approx(18.0)
    assert found[f"{arm} {np.digitize(1.5, PHI_EDGES) - 1}"] == pytest.approx(1.0)
    assert found[f"{arm} own"] == found[f"{arm} either"] == 1.0
    assert found[f"{arm} late"] / found[f"{arm} rotates"] == pytest.approx(0.95)
    astray = script.features_of(arm, {bw_s: turning(-angle) for bw_s in LEVELS_S})
    assert astray[f"{arm} own"] == astray[f"{arm} tangent 1.4"] == 0.0


def test_a_flock_without_leaders_has_both_tangents(script: ModuleType) -> None:
    found = script.features_of("free", {bw_s: turning(1.5) for bw_s in LEVELS_S})
    assert found["free tangent 1.4"] == pytest.approx(9.0)
    assert (found["free cw"], found["free ccw"]) == (1.0, 0.0)


def falling(script: ModuleType) -> tuple[list[str], np.ndarray]:
    """Features of two seeds; Ψ_o falls by 0.5 per s from 1, and 0.1 s later in the second."""
    names, rows = [], []
    for arm in script.ARMS:
        for bw_s in LEVELS_S:
            names += [f"{arm} psi_o {bw_s:g}", f"{arm} tangent {bw_s:g}"]
            later = [1.0 - 0.5 * (bw_s - 0.1 * seed) for seed in range(2)]
            rows += [later, [6.0 * each for each in later]]
    return names, np.array(rows).T


def test_order_is_lost_where_the_mean_curve_falls_through_the_level(script: ModuleType) -> None:
    names, values = falling(script)
    both = script.Means(names, values)
    found = script.lost(both.curve("free", "psi_o"), 0.3)
    assert found == pytest.approx([1.4, 1.5])
    # 6 (1 - 0.5 bw) is 2 at 4/3 s and 3 at 1 s.
    lost = script.direction_lost(both.led("tangent"))
    assert lost == pytest.approx([7 / 6, 7 / 6 + 0.1])
    nothing = script.Means(names, 0.0 * values)
    assert script.lost(nothing.curve("free", "psi_o"), 0.3) == pytest.approx([0.0, 0.0])


def test_an_interval_draws_seeds(script: ModuleType) -> None:
    names, values = falling(script)
    many = pd.DataFrame(np.repeat(values, 6, axis=0), columns=names)
    found = script.over_seeds([many], lambda m: script.lost(m.curve("free", "psi_o"), 0.3))
    assert found.runs == 12
    assert found[0] == pytest.approx(1.45)
    assert 1.41 < found[1] < 1.43 < 1.47 < found[2] < 1.49
    same = script.over_seeds([many, many], lambda a, b: a["free psi_o 0"] - b["free psi_o 0"])
    assert same == pytest.approx((0.0, 0.0, 0.0))


def test_a_misfit_counts_tolerances_outside_of_the_range(script: ModuleType) -> None:
    inside = [max(number.least, min(number.most, 1.0)) for number in CARD]
    assert script.misfit(inside) == 0.0
    place = list(BY_NAME).index("jams at 0.4 s")
    for value, expected in ((0.5, 4.0), (0.3, 0.0), (0.01, 0.01), (0.9, script.WORST)):
        changed = [*inside[:place], value, *inside[place + 1 :]]
        assert script.misfit(changed) == pytest.approx(expected)
    assert script.misfit([math.nan, *inside[1:]]) == script.WORST


@pytest.mark.parametrize(("value", "expected"), [(0.5, 6.25), (0.3, 0.25), (0.01, 0.36), (0.25, 0)])
def test_a_margin_narrows_the_range_at_both_ends(
    script: ModuleType, value: float, expected: float
) -> None:
    values = [max(number.least, min(number.most, 1.0)) for number in CARD]
    place = list(BY_NAME).index("jams at 0.4 s")
    within, moved = ([*values[:place], each, *values[place + 1 :]] for each in (0.16, value))
    assert script.misfit(moved, 0.5) - script.misfit(within, 0.5) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("interval", "verdict"),
    [
        ((0.2, 0.1, 0.3), "holds"),
        ((0.2, 0.1, 0.31), "open"),
        ((0.4, 0.31, 0.5), "fails"),
        ((0.2, math.nan, math.nan), "open"),
    ],
)
def test_a_verdict_needs_the_whole_interval(
    interval: tuple[float, float, float], verdict: str
) -> None:
    assert BY_NAME["jams at 0.4 s"].verdict(interval) == verdict


def test_ten_misses_have_to_be_mended() -> None:
    assert len(BY_NAME) == len(CARD)
    assert sum(number.missed for number in CARD) == 10
