"""Law: candidates follow from their numbers, and one replaces the preset by the whole rule."""

import math
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

import flockenv
from studies.calibration.score_card import CARD, Number
from studies.claim import Interval
from studies.store import StudyError
from studies.study import Options, Row


def test_constants_lie_in_their_ranges_and_turn_as_they_say(script: ModuleType) -> None:
    random = np.random.default_rng(1)
    for place in [*random.random((50, 9)), np.zeros(9), np.ones(9)]:
        found = script.constants_at(place)
        low, high = np.array(list(script.RANGES.values())).T
        constants = [found[name] for name in script.RANGES]
        assert (low <= constants).all()
        assert (constants <= high).all()
        # At this rate the torque of the boat that backs up balances the drag.
        slow, fast = script.TURNS_RAD_S
        turn = slow * (fast / slow) ** place[-1]
        lag = found["c0"] ** 2 / (found["c0"] ** 2 + turn**2)
        push = found["c3"] * found["reverse_speed_cm_s"] * lag
        assert push == pytest.approx(found["c1"] * turn**2, rel=1e-3)
        assert script.place_of(constants, turn) == pytest.approx(list(place), abs=1e-3)
        flockenv.FlockParameters.preset("experiment").replace(**found)
    earlier = script.constants_at(script.place_of(script.EARLIER))
    assert [earlier[name] for name in script.RANGES] == list(script.EARLIER)
    assert earlier["c1"] == pytest.approx(0.4944, rel=1e-3)


def test_constants_too_slow_or_too_fast_for_table_1_are_drawn_again(script: ModuleType) -> None:
    earlier = script.constants_at(script.place_of(script.EARLIER))
    assert script.is_fast_enough(earlier)
    assert not script.is_fast_enough(earlier | {"speed_cm_s": 14.0})
    assert not script.is_fast_enough(earlier | {"speed_cm_s": 22.0, "c0": 2.0})


def test_parts_have_seeds_of_their_own(script: ModuleType) -> None:
    most = {
        "search": script.GENERATIONS * script.SEARCH_SEEDS,
        "choice": script.CHOICE_SEEDS,
        "judgment": script.JUDGMENT_SEEDS,
    }
    # The earlier search's: 97 candidates, 4 seeds of choice, 12 of judgment.
    earlier = {"search": 97, "choice": 4, "judgment": 12}
    for use, part in script.PARTS.items():
        first = script.row(7, {}, use, 0)["first_seed"]
        assert earlier[use] <= first - part.first
        assert first + most[use] - 1 in part.every


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


def test_a_finalist_is_chosen_by_what_it_loses_mends_and_misfits(script: ModuleType) -> None:
    best = script.worth(judgment(script, 5), 20.0)
    assert best > script.worth(judgment(script, 5), 21.0)
    assert best > script.worth(judgment(script, 4), 1.0)
    assert best > script.worth(judgment(script, 9, lost=True), 1.0)
    assert script.worth(judgment(script, 0), 99.0) > script.worth(judgment(script, 9, lost=True), 1)


@pytest.fixture
def short_search(
    script: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> tuple[Options, list[int]]:
    """A search of eight generations in which c0 alone counts, best at 1, and its runs so far."""
    made = []

    def away(row: Row) -> Row:
        made.append(row["candidate"])
        values = {number.name: inside(number)[0] for number in CARD}
        return values | {"jams at 0 s": 0.55 - abs(math.log(row["c0"]))}

    monkeypatch.setattr(script, "_search", away)
    monkeypatch.setattr(script, "GENERATIONS", 8)
    return Options(workers=1, out=tmp_path), made


def test_a_search_comes_nearer_and_goes_on_where_it_was_stopped(
    script: ModuleType, short_search: tuple[Options, list[int]]
) -> None:
    options, made = short_search
    table, middle = script.searched(options)
    assert abs(math.log(middle["c0"])) < 0.5 * abs(math.log(script.EARLIER[2]))
    assert table.groupby("seed").size().tolist() == [script.POPULATION] * 8
    assert sorted(made) == list(range(8 * script.POPULATION))
    path = options.out / "calibration" / "results" / "search.csv"
    lines = path.read_text("utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:60]), "utf-8")
    made.clear()
    pd.testing.assert_frame_equal(script.searched(options)[0], table)
    assert sorted(made) == list(range(59, 8 * script.POPULATION))


def test_candidates_of_another_search_are_refused(
    script: ModuleType, short_search: tuple[Options, list[int]]
) -> None:
    options, _ = short_search
    script.searched(options)
    path = options.out / "calibration" / "results" / "search.csv"
    other = path.read_text("utf-8").replace(",2.5,2.37,", ",2.5,2.38,", 1)
    path.write_text(other, "utf-8")
    for runs in (True, False):
        with pytest.raises(StudyError, match="a store of another design: 1 of its runs"):
            script.searched(Options(workers=1, out=options.out, runs=runs))
    assert path.read_text("utf-8") == other


def test_a_search_without_all_of_its_runs_is_not_judged(
    script: ModuleType, short_search: tuple[Options, list[int]]
) -> None:
    options, _ = short_search
    script.searched(options)
    path = options.out / "calibration" / "results" / "search.csv"
    path.write_text("".join(path.read_text("utf-8").splitlines(keepends=True)[:60]), "utf-8")
    with pytest.raises(StudyError, match="lacks runs"):
        script.searched(Options(out=options.out, runs=False))


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
