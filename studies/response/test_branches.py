"""Law: both branches meet one noise, each leader changes sides, and no boat pairs with itself."""

import itertools

import numpy as np
import pytest

from studies.study import FIRST_SEED

ROW = {"n_boats": 27, "bw_s": 0.31, "dt_s": 0.05, "states": 2, "minutes": 0.25, "seed": 950_000}


def led(leaders: int, against: int = 0) -> dict:
    return ROW | {"policy": "law", "leaders": leaders, "against": against}


def test_only_pairs_of_different_boats_fluctuate_together(script) -> None:
    """A sign that all boats share and change at random, and boats that have signs of their own."""
    random = np.random.default_rng(1)
    shared = random.choice((-1.0, 1.0), (20000, 1)).repeat(5, axis=1)
    own = random.choice((-1.0, 1.0), (20000, 5))
    found = script.fluctuation(np.stack([shared, own]), 3)
    assert found[:, 0] == pytest.approx(0.0)
    assert found[0, 1:] == pytest.approx(1.0, abs=0.03)
    assert found[1, 1:] == pytest.approx(0.0, abs=0.02)
    assert script.equal_times(shared)["pairs_late"] == pytest.approx(1.0)
    assert script.equal_times(own)["pairs_early"] == pytest.approx(0.0, abs=0.02)


def test_branches_meet_one_noise(script) -> None:
    """Three cycles long most boats are not yet reached by what one leader does."""
    states, _ = script.trunk(led(1))
    ends = [script.followed(led(1), sides, states[0]).pose[-1] for sides in (["cw"], ["ccw"], [])]
    for one, other in ((0, 1), (0, 2)):
        away_cm = np.hypot(*(ends[one] - ends[other])[:, :2].T)
        assert away_cm[0] > 0.1
        assert np.median(away_cm) < 1e-6
    assert np.ptp([state["time_s"] % 4.31 for state in states]) < 1e-6


def test_every_leader_changes_sides(script, monkeypatch) -> None:
    """And the response is half of the difference, of the boats that do not lead."""
    heard = []

    def heading(row, sides, state):
        heard.append(sides)
        return np.array([[1.0 if side == "cw" else -1.0 for side in sides] + [sum_of(sides)] * 2])

    def sum_of(sides):
        return sides.count("cw") - sides.count("ccw")

    monkeypatch.setattr(script, "trunk", lambda row: ([None] * script.STRETCHES, None))
    monkeypatch.setattr(script, "followed", heading)
    monkeypatch.setattr(script, "by_boat", lambda found: np.stack([found, found]))
    assert script.response(led(2, 1)).tolist() == [[1.0], [1.0]]
    assert heard == [["cw", "cw", "ccw"], ["ccw", "ccw", "cw"]] * 2


def test_runs_have_all_windows_that_they_reach(script) -> None:
    found = script.measure(led(2, 1))
    assert np.isfinite([found["m_0"], found["velocity_0"]]).all()
    assert np.isnan([found["m_1"], found["pairs_late"]]).all()
    free = script.measure(led(0))
    assert abs(free["m_0"]) < 0.1
    assert 0.0 < free["m_squared"] < 1.0


def test_the_boats_agree_with_the_recorded_order(script) -> None:
    states, boats = script.trunk(led(0))
    run = script.followed(led(0), (), states[0])
    m = run.analyzed(0.0).order.rotation().reshape(-1, script.ANALYZED).mean(axis=1)
    assert boats[0, : len(m)].mean(axis=1) == pytest.approx(m)


def test_a_kind_of_flock_is_made_for_one_seed_at_a_time(script) -> None:
    """So that its flock without leaders is run once."""
    names = ("n_boats", "bw_s", "dt_s", "seed")
    flocks = [tuple(row[name] for name in names) for row in script.design()]
    changes = sum(one != other for one, other in itertools.pairwise(flocks))
    assert changes == len(set(flocks)) - 1
    assert min(flock[-1] for flock in flocks) + FIRST_SEED < 2**32
