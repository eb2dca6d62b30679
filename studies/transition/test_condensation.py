"""Law: a lever rule is one coverage outside of jams, and a start half in a jam overlaps nobody."""

from types import ModuleType

import numpy as np
import pandas as pd
import pytest

import flockenv


def runs(n: int, coverage: float, start: str, outside: float, seeds: int = 4) -> pd.DataFrame:
    """Flocks with nearly one coverage outside of their jams, the same in every hour."""
    lines = []
    for seed in range(seeds):
        in_jams = 1.0 - (outside + 0.001 * seed) / coverage
        line = {"c4": 0.1, "n_boats": float(n), "coverage": coverage, "start": start}
        line |= {f"in_jams_{hour}": in_jams for hour in (1, 2, 3)}
        lines.append(line)
    return pd.DataFrame(lines)


def flocks(outside: dict[tuple[int, float, str], float]) -> pd.DataFrame:
    return pd.concat([runs(*key, value) for key, value in outside.items()], ignore_index=True)


CELLS = [
    (n, coverage, start)
    for n in (100, 200)
    for coverage in (0.3, 0.6)
    for start in ("one-jam", "rotating", "half-and-half")
]


def test_one_coverage_outside_is_condensation(script: ModuleType) -> None:
    claims = script.judge(flocks(dict.fromkeys(CELLS, 0.2)))
    assert {claim.verdict for claim in claims} == {"holds"}
    assert len(claims) == 2 * (1 + 2 * 3) + 2


@pytest.mark.parametrize(
    ("differs", "words"),
    [
        (lambda n, coverage, start: coverage == 0.6, "are added join"),
        (lambda n, coverage, start: start == "rotating", "All starts"),
        (lambda n, coverage, start: n == 200, "twice the size"),
    ],
)
def test_each_part_of_the_rule_can_fail(script: ModuleType, differs, words: str) -> None:
    cells = {cell: 0.27 if differs(*cell) else 0.2 for cell in CELLS}
    failed = {claim.claim for claim in script.judge(flocks(cells)) if claim.verdict == "fails"}
    assert len(failed) == 1
    assert words in failed.pop()


def test_a_jam_that_still_melts_is_not_stationary(script: ModuleType) -> None:
    table = flocks(dict.fromkeys(CELLS, 0.2))
    table["in_jams_2"] += 0.2
    failed = {claim.claim for claim in script.judge(table) if claim.verdict == "fails"}
    assert failed == {"The boats outside of jams do not change any more"}


def test_flocks_without_jams_say_nothing_of_the_outside(script: ModuleType) -> None:
    table = runs(100, 0.3, "one-jam", 0.29)
    assert script.outside(table).isna().all()
    assert len(script.judge(table)) == 0


def test_half_stand_in_one_jam_and_half_go_round(script: ModuleType) -> None:
    outer = script.outer_radius_cm(100, 0.6)
    parameters = flockenv.FlockParameters(
        n_boats=100, bw_s=0.0, pool=(outer, outer - script.WIDTH_CM)
    )
    boats = script.half_and_half(parameters, 3)  # An overlap would be an error.
    assert [*script.jam_sizes(parameters, boats.pose[None])[0]] == [50]
    speed = np.hypot(*boats.velocity[:, :2].T)
    assert speed[:50] == pytest.approx(0.0)
    assert speed[50:] == pytest.approx(parameters.speed_cm_s)
    order = boats.order_parameters()
    assert order.psi_o * np.sin(order.phi_o) == pytest.approx(0.5)  # Clockwise.


def test_the_time_of_a_change_is_that_of_ten_minutes(script: ModuleType) -> None:
    """Jams of a tenth of the boats that are gone after an hour, sampled each 20 s."""
    samples = np.zeros((540, 5))
    samples[:180, 1] = 0.1
    row = script.hours(samples, rotates=False)
    assert (row["in_jams_1"], row["in_jams_2"]) == pytest.approx((0.1, 0.0))
    assert row["changed_min"] == pytest.approx(55.0, abs=0.5)
    assert script.hours(samples[::-1], rotates=True)["changed_min"] == pytest.approx(115.0, abs=0.5)


def test_a_block_that_is_not_whole_is_not_judged(script: ModuleType) -> None:
    table = pd.DataFrame({"c4": 0.1, "n_boats": 100, "seed": [0, 0, 0, 1, 1]})
    assert script.whole_blocks(table)["seed"].tolist() == [0, 0, 0]
