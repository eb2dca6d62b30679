"""Law: a statement holds if its interval lies within its bounds; runs are those that bear it."""

import math

import numpy as np
import pytest

from studies import claim


@pytest.mark.parametrize(
    ("found", "verdict", "decide"),
    [
        ((1.0, 0.6, 1.4), "holds", ""),
        ((0.0, -0.4, 0.4), "fails", ""),
        # Half as wide with four times the runs.
        ((1.0, 0.0, 2.0), "open", "96"),
        ((0.5, 0.0, 1.0), "open", "more than 10000"),
        ((math.nan,) * 3, "open", ""),
    ],
)
def test_verdicts(found: tuple[float, float, float], verdict: str, decide: str) -> None:
    judged = claim.Claim("", "", "", "", claim.Interval(found, 24), least=0.5)
    assert (judged.verdict, judged.would_decide) == (verdict, decide)


def test_existence_has_one_bound() -> None:
    claims = claim.Claims("", "")
    for count, runs in ((0, 24), (1, 24), (5, 24), (0, 100), (12, 100)):
        claims.exists("it happens", "", count, runs)
    # One run of 24 may be one in a thousand: the bound does not move to what was found.
    assert [each.verdict for each in claims] == ["open", "open", "holds", "fails", "holds"]
    assert {each.least for each in claims} == {claim.OCCURS}


def test_runs_are_those_that_bear_the_interval() -> None:
    # 24 seeds at four noises each, whose means over the noises are averaged.
    assert claim.mean(np.arange(24.0)).runs == 24
    pairs = np.random.default_rng(0).normal(size=(24, 2))
    assert claim.bca([pairs, pairs], lambda *each: sum(g[..., 0].mean(-1) for g in each)).runs == 48
    assert claim.proportion(3, 7).runs == 7


def test_critical_noise_of_a_straight_fall() -> None:
    noises = [0.0, 0.1, 0.2, 0.3, 0.4]
    fall = [0.9, 0.9, 0.6, 0.3, 0.1]
    groups = [np.full((4, 2), level) for level in fall]
    # The middle of 0.9 and 0.1 is 0.5, a third of the way from 0.6 to 0.3.
    assert claim.fall(noises, groups) == pytest.approx(0.2 + 0.1 / 3)
    jam = [np.array([[level, 0.2]] * 4) for level in fall]
    assert math.isnan(claim.critical_bw(noises, jam)[0])


def test_a_fall_is_where_a_line_crosses_the_level() -> None:
    """Of two draws: one rises again before it falls, and one never is above the level."""
    y = np.array([[0.9, 0.2], [0.1, 0.1], [0.5, 0.1], [0.1, 0.0]])
    found = claim.crossing([0.0, 1.0, 2.0, 3.0], y, 0.3)
    assert found[0] == pytest.approx(2.5)
    assert math.isnan(found[1])
    assert claim.crossing([0.0, 1.0], np.array([[0.9], [0.8]]), 0.3) == [1.0]


def test_order_that_is_not_lost_has_no_noise_at_which_it_is() -> None:
    random = np.random.default_rng(0)
    falls = [level + 0.01 * random.normal(size=(24, 1)) for level in (0.9, 0.5, 0.1)]
    stays = [level + 0.01 * random.normal(size=(24, 1)) for level in (0.9, 0.5, 0.4)]
    levels = [1.0, 2.0, 3.0]
    assert claim.disorder(levels, [falls])[0] == pytest.approx(2.5, abs=0.02)
    shift = claim.disorder(levels, [falls, falls], (1.0, -1.0))
    assert shift[0] == pytest.approx(0.0, abs=1e-9)
    assert all(map(math.isnan, claim.disorder(levels, [falls, stays], (1.0, -1.0))))


def test_few_runs_print_one_digit_and_ties_are_ties() -> None:
    def last_digits(runs: np.ndarray) -> np.ndarray:
        means = runs[..., 0].mean(-1)
        return np.asarray(means * (1.0 + 1e-15 * np.sign(np.sin(1e6 * means))))

    few = np.array([[0.0], [0.0], [1.0], [1.0], [1.0], [0.0], [0.0], [1.0]])
    found = claim.bca([few], last_digits)
    assert found == claim.bca([few], lambda runs: runs[..., 0].mean(-1))
    assert found.texts()[0] == "0.5"
    assert claim.bca([np.repeat(few, 3, axis=0)], last_digits).digits == 3
    assert claim.Interval((0.1234, 0.01, 1.26), 8, 1).texts() == ["0.1", "0.01", "1"]
