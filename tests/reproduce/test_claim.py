"""A claim holds where its whole interval lies in the claimed range, and only there."""

import math

import pytest

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, INCONCLUSIVE, Claim


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [
        (0.62, 0.78, HOLDS),
        (0.6, 0.8, HOLDS),
        (0.5, 0.7, INCONCLUSIVE),
        (0.7, 0.9, INCONCLUSIVE),
        (0.1, 2.0, INCONCLUSIVE),
        (0.1, 0.59, DOES_NOT_HOLD),
        (0.81, 0.9, DOES_NOT_HOLD),
        (math.nan, math.nan, INCONCLUSIVE),
    ],
)
def test_the_verdict(low: float, high: float, verdict: str) -> None:
    claim = Claim(text="", section="5.2", quantity="", low=0.6, high=0.8)
    assert claim.check((low + high) / 2, low, high).verdict == verdict


def test_half_open_ranges() -> None:
    least = Claim(text="", section="", quantity="", low=0.5)
    assert least.accepted == "≥ 0.5"
    assert least.check(0.9, 0.8, 1.0).verdict == HOLDS
    most = Claim(text="", section="", quantity="", high=0.0)
    assert most.accepted == "≤ 0"
    assert most.check(0.2, 0.1, 0.3).verdict == DOES_NOT_HOLD
    assert most.check(math.nan, math.nan, math.nan).verdict == INCONCLUSIVE


def test_no_difference_at_all_is_no_evidence_for_its_sign() -> None:
    more = Claim(text="More", section="", quantity="difference", low=0.0)
    assert more.check(0.0, 0.0, 0.0).verdict == INCONCLUSIVE
    assert more.check(0.1, 0.0, 0.2).verdict == HOLDS
    rare = Claim(text="Rare", section="", quantity="share", low=0.0, high=0.05)
    assert rare.check(0.0, 0.0, 0.0).verdict == HOLDS
    equal = Claim(text="Equal", section="", quantity="difference", low=-0.1, high=0.1)
    assert equal.check(0.0, 0.0, 0.0).verdict == HOLDS


def test_an_open_claim_says_how_many_runs_would_decide_it() -> None:
    more = Claim(text="More", section="", quantity="difference", low=0.0)
    open_claim = more.check(0.1, -0.1, 0.3, note="of 50 boats").with_needs(8, "seeds")
    assert open_claim.note == "of 50 boats; inconclusive: needs about 32 seeds, where it has 8"
    assert more.check(0.2, 0.1, 0.3).with_needs(8, "seeds").note == ""


def test_a_claim_needs_some_seeds() -> None:
    more = Claim(text="More", section="", quantity="difference", low=0.0).check(0.2, 0.1, 0.3)
    assert more.of_seeds(8) == more
    few = more.of_seeds(7)
    assert few.verdict == INCONCLUSIVE
    assert few.note == "inconclusive: needs 8 seeds, where it has 7"
