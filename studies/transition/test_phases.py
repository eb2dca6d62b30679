"""Law: a state lasts where most flocks stay in it, and what one study judged another does not."""

from types import ModuleType

import pandas as pd
import pytest

from studies.study import Row


def runs(noise: Row, n: int, coverage: float, jam: float, rotating: float) -> pd.DataFrame:
    """Six flocks of two starts with nearly one share in jams in every hour."""
    lines = []
    for start, in_jams in (("one-jam", jam), ("rotating", rotating)):
        for seed in range(3):
            share = in_jams * (1.0 + 0.01 * seed)
            line = noise | {"n_boats": float(n), "coverage": coverage, "start": start, "seed": seed}
            for hour in (1, 2, 3):
                names = {"in_jams": share, "abs_m": 1.0 - share, "slow": share}
                line |= {f"{name}_{hour}": value for name, value in names.items()}
            lines.append(line)
    return pd.DataFrame(lines)


def of_map(script: ModuleType, jam: float, rotating: float) -> pd.DataFrame:
    return pd.concat([runs(script.NOISES[0], 200, each, jam, rotating) for each in (0.3, 0.6)])


@pytest.mark.parametrize(
    ("jam", "rotating", "verdict"),
    [(0.4, 0.0, "holds"), (0.04, 0.0, "fails"), (0.8, 0.8, "fails"), (0.8, 0.49, "holds")],
)
def test_both_last_where_both_starts_stay(script, jam: float, rotating: float, verdict) -> None:
    table = of_map(script, jam, rotating)
    claims = script.judge(table, table.iloc[:0])
    assert claims[0].claim == "One jam and rotation both last for three hours"
    assert claims[0].verdict == verdict
    assert claims[0].found.runs == 6


def test_the_neighbors_are_those_with_the_most_of_the_rarer_state(script: ModuleType) -> None:
    cells = {0.2: (0.0, 0.0), 0.3: (0.5, 0.0), 0.4: (0.5, 0.0), 0.6: (0.9, 0.9)}
    table = pd.concat([runs(script.NOISES[0], 200, each, *cells[each]) for each in cells])
    pair, share = script.both_last(table)
    assert pair == "coverages 0.3 and 0.4"
    assert share[0] == 1.0


def test_bounds_twice_as_strict(script: ModuleType) -> None:
    table = runs(script.NOISES[0], 200, 0.3, 0.06, 0.3)
    assert script.lasts(table).all()
    assert not script.lasts(table, 2.0).any()


def test_a_flock_with_jams_that_rotates_counts_for_both_unless_they_are_apart(script) -> None:
    table = runs(script.NOISES[0], 200, 0.3, 0.06, 0.04)
    assert script.lasts(table).all()
    assert script.lasts(table, 1.0, True).tolist() == [False] * 3 + [True] * 3


def test_a_mixed_start_is_no_state_that_lasts(script: ModuleType) -> None:
    mixed = runs(script.NOISES[3], 200, 0.3, 0.5, 0.0).replace("one-jam", "half-and-half")
    assert script.cells(mixed)["last"].tolist() == ["", 3]


def test_boats_added_to_one_ring_are_twice_the_boats_at_twice_the_coverage(script) -> None:
    """0.1 stay outside of jams in both, but 0.2 in the denser ring of as many boats."""
    noise = script.NOISES[0]
    few, more = runs(noise, 200, 0.3, 2 / 3, 2 / 3), runs(noise, 400, 0.6, 5 / 6, 5 / 6)
    table = pd.concat([few, more, runs(noise, 200, 0.6, 2 / 3, 2 / 3)])
    claims = [each for each in script.judge(table, table.iloc[:0]) if "to a ring" in each.claim]
    assert [each.quantity for each in claims] == [
        "boats outside of jams per boat added, 200 to 400 boats"
    ]
    assert claims[0].found[0] == pytest.approx(0.0, abs=0.02)
    assert claims[0].verdict == "holds"


def test_more_stays_outside_at_a_stronger_noise(script: ModuleType) -> None:
    weak, strong = script.NOISES[:2]
    table = pd.concat([runs(weak, 200, 0.6, 0.9, 0.9), runs(strong, 200, 0.6, 0.7, 0.7)])
    found = [each for each in script.judge(table, table.iloc[:0]) if "stronger" in each.claim]
    assert found[0].verdict == "holds"
    assert found[0].found[0] == pytest.approx(0.6 * 0.2, abs=0.01)


def test_a_statement_of_the_earlier_runs_is_not_judged_again(script: ModuleType) -> None:
    before = runs(script.NOISES[3], 400, 0.6, 0.7, 0.7)
    own = runs(script.NOISES[3], 800, 0.6, 0.5, 0.5)
    readings = {each.reading for each in script.judge(own, before) if "start" in each.claim}
    assert all(reading.endswith("n = 800") for reading in readings)
    twice = [each for each in script.judge(own, before) if "twice the size" in each.claim]
    assert [each.verdict for each in twice] == ["fails"]


def test_a_block_that_is_not_whole_is_not_judged(script: ModuleType) -> None:
    table = pd.DataFrame(script.design()[:100])
    whole = script.whole_blocks(table)
    assert set(whole["seed"]) == {script.FIRST}
    assert 50 < len(whole) < 100


def test_no_run_of_the_earlier_study_is_made_again(script: ModuleType) -> None:
    names = ["scheme", "c4", "n_boats", "coverage", "start"]
    cells = [
        {tuple(row[name] for name in names) for row in design}
        for design in (script.design(), script.condensation.design())
    ]
    assert not cells[0] & cells[1]
