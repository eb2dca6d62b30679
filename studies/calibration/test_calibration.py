"""Law: candidates follow from their numbers, and one replaces the preset by the whole rule."""

import math
from pathlib import Path
from types import ModuleType

import pandas as pd
import pytest

import flockenv
from studies.calibration.score_card import CARD, Number
from studies.claim import Interval


def test_candidates_are_drawn_in_the_ranges(script: ModuleType) -> None:
    pilots = len(script.PILOTS)
    first = [script.drawn(number, []) for number in range(50)]
    assert first == [script.drawn(number, []) for number in range(50)]
    assert [each["c1"] for each in first[:pilots]] == pytest.approx(
        [0.678] * 2 + [0.448] * 2, rel=0.01
    )
    for found in first:
        assert all(low <= found[name] <= high for name, (low, high) in script.RANGES.items())
        assert 10.0 <= found["speed_cm_s"] * (1 - math.exp(-2 * found["c0"])) <= 20.0
        # At w = 1 rad/s the torque of the boat that backs up balances the drag.
        push = found["c3"] * found["reverse_speed_cm_s"] * found["c0"] ** 2
        assert push / (found["c0"] ** 2 + 1) == pytest.approx(found["c1"], rel=1e-3)
        flockenv.FlockParameters.preset("experiment").replace(**found)
    parent = first[pilots]
    near = [script.drawn(number, [parent]) for number in range(100, 300)]
    ratios = [math.log(each["c2"] / parent["c2"]) for each in near]
    assert abs(sum(ratios) / len(ratios)) < 0.1
    assert 0.15 < (sum(r * r for r in ratios) / len(ratios)) ** 0.5 < 0.4


def test_parts_have_seeds_of_their_own(script: ModuleType) -> None:
    seeds = {
        use: script.row(7, {}, use, 3)["first_seed"] + script.row(7, {}, use, 3)["seed"]
        for use in script.PARTS
    }
    assert all(seed in script.PARTS[use].every for use, seed in seeds.items())
    assert script.row(8, {}, "search", 0)["first_seed"] == seeds["search"] - 3 + 1
    assert script.row(8, {}, "judgment", 3)["first_seed"] + 3 == seeds["judgment"]


def inside(number: Number) -> Interval:
    value = max(number.least, min(number.most, 1.0))
    return Interval((value, value, value), 24)


def outside(number: Number) -> Interval:
    value = number.least - 1.0 if math.isfinite(number.least) else number.most + 1.0
    return Interval((value, value, value), 24)


def judgment(script: ModuleType, mended: int, *, lost: bool = False, high: float = -1.0):  # type: ignore[no-untyped-def]
    left = mended
    ours = []
    for number in CARD:
        good = not number.missed or left > 0
        left -= number.missed and good
        ours.append(inside(number) if good else outside(number))
    if lost:
        place = [number.missed for number in CARD].index(False)
        ours[place] = outside(CARD[place])
    theirs = [outside(number) if number.missed else inside(number) for number in CARD]
    return script.Judgment(ours, theirs, Interval((-5.0, -9.0, high), 24))


def test_the_rule_needs_all_three(script: ModuleType) -> None:
    assert judgment(script, 5).replaces()
    assert len(judgment(script, 5).mended()) == 5
    assert not judgment(script, 4).replaces()
    assert not judgment(script, 10, lost=True).replaces()
    assert not judgment(script, 10, high=0.1).replaces()
    assert judgment(script, 10, lost=True).lost() == ["jams at 0 s"]


def test_the_page_has_the_numbers_of_both_cards() -> None:
    folder = Path(__file__).parent
    claims = pd.read_csv(folder / "claims.csv")
    page = (folder / "README.md").read_text("utf-8")
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")][2:]
    assert len(rows) == len(CARD)
    answers = {"holds": "match", "fails": "miss", "open": "undecided"}
    for place, reading in ((4, "experiment"), (5, "candidate")):
        lines = claims[claims["reading"].str.match(f"{reading}.*, narrow")]
        for cells, (_, line) in zip(rows, lines.iterrows(), strict=True):
            shown = f"{line['measured']:.3g}, {answers[line['verdict']]}".replace("-", "−")
            assert cells[place].removesuffix(" |") == shown
