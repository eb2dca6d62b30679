"""Law: an error is inside only if its whole interval is, and a bias only if it shows.

A physics with more order at a noise loses it at a higher noise.
"""

import itertools
import math
from contextlib import nullcontext
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import pytest
from matplotlib.figure import Figure

import flockenv
from docs.scripts.plots import page_style
from studies.claim import Interval
from studies.step_size import step_size
from studies.study import Options


@pytest.mark.parametrize(
    ("low", "high", "answer"),
    [
        (-0.009, 0.008, "inside"),
        (0.002, 0.009, "inside"),
        (-0.011, 0.005, "undecided"),
        (0.002, 0.012, "bias"),
        (-0.09, -0.02, "bias"),
    ],
)
def test_an_interval_is_answered_by_the_rule(low: float, high: float, answer: str) -> None:
    assert step_size.answer(Interval(((low + high) / 2, low, high), 24)) == answer


def test_an_error_is_a_difference_within_a_seed() -> None:
    """Seeds that lack one of the two runs do not count."""
    rows = [
        {"pool": "wide", "n_boats": 27, "leaders": step_size.NOBODY, "physics": physics}
        | {"seed": seed, "psi_o": 0.1 * seed + shift, "c_v": 0.0, "signed_order": 0.0}
        for physics, shift, last in (("reference", 0.0, 6), ("training", 0.03, 4))
        for seed in range(last)
    ]
    found = {
        (name, physics): error for name, _, physics, error in step_size.errors(pd.DataFrame(rows))
    }
    assert set(found) == {("psi_o", "training"), ("c_v", "training")}
    assert found["psi_o", "training"] == pytest.approx((0.03, 0.03, 0.03))
    assert found["psi_o", "training"].runs == 4


@pytest.mark.parametrize(("slope", "shift"), [(-1.5, 0.02), (-3.0, 0.01), (0.0, math.nan)])
def test_an_error_of_the_order_is_a_shift_of_the_noise(slope: float, shift: float) -> None:
    """Where the order does not change with the noise, there is no shift."""
    flock = {"pool": "wide", "n_boats": 27, "leaders": step_size.NOBODY}
    luck = [0.01, -0.01, 0.02, -0.02, 0.0, 0.0]
    runs = [
        flock | {"physics": physics, "seed": seed, "psi_o": 0.4 + psi_o}
        for seed, more in enumerate(luck)
        for physics, psi_o in (("reference", 0.0), ("training", 0.03 + more))
    ]
    sides = [
        flock | {"away_s": away_s, "seed": seed, "psi_o": 0.4 + slope * away_s + more * away_s}
        for seed, more in enumerate(luck)
        for away_s in (-step_size.AWAY_S, step_size.AWAY_S)
    ]
    ((_, _, physics, found),) = step_size.shifts(pd.DataFrame(runs), pd.DataFrame(sides))
    assert physics == "training"
    assert found[0] == pytest.approx(shift, nan_ok=True)
    assert math.isnan(shift) or found[1] < shift < found[2]


@pytest.mark.parametrize("physics", ["training", "publication"])
def test_the_physics_are_those_of_the_environments(physics: str) -> None:
    env = flockenv.LeadersEnv(physics=physics)
    parameters = env.parameters
    assert (parameters.dt_s, parameters.tolerance_cm) == step_size.PHYSICS[physics]


def test_numbers_below_the_picture_do_not_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are as wide as their signs, and became a row without gaps."""
    folder = Path(step_size.__file__).parent
    table, slopes = (
        pd.read_csv(folder / "results" / f"{name}.csv.gz") for name in ("step_size", "slopes")
    )
    with mpl.rc_context(page_style(9.0)):
        figure = Figure(figsize=(6.7, 5.9), layout="constrained")
        monkeypatch.setattr(step_size, "picture", lambda *_, **__: nullcontext(figure))
        step_size.draw(Options(folder), table, slopes)
        figure.draw_without_rendering()
    for axes in figure.axes:
        boxes = [label.get_window_extent() for label in axes.get_xticklabels() if label.get_text()]
        assert len(boxes) > 3
        assert all(one.x1 < other.x0 for one, other in itertools.pairwise(boxes))
