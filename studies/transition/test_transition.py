"""Law: a jam that splits lasts by the second rule, and a map answers by its largest flocks."""

from types import ModuleType

import pandas as pd
import pytest

from studies import claim
from studies.transition import transition_runs


def test_a_jam_that_splits_lasts_by_the_second_rule(script: ModuleType) -> None:
    # Start, whether and when its largest jam fell below half, and what its last minutes were.
    runs = pd.DataFrame(
        [
            ("one-jam", 1, 30.0, 0.1, 0.9),  # Split: still in jams when its run ended.
            ("one-jam", 1, 110.0, 0.1, 0.9),
            ("one-jam", 1, 30.0, 0.8, 0.6),  # Came to rotate.
            ("one-jam", 1, 30.0, 0.1, 0.2),  # Dissolved.
            ("one-jam", 0, 119.7, 0.0, 1.0),
            ("rotating", 0, 119.7, -0.9, 0.0),
            ("rotating", 1, 10.0, 0.2, 0.7),
        ],
        columns=["start", "exited", "stayed_min", "m", "in_jams"],
    ).assign(minutes=120.0)
    found = script.second(runs)
    assert list(found["exited"]) == [0, 0, 1, 1, 0, 0, 1]
    assert list(found["stayed_min"]) == [50.0, 120.0, 30.0, 30.0, 119.7, 119.7, 10.0]


def test_answers_of_a_map(script: ModuleType) -> None:
    claims = claim.Claims("", "")
    for cell, large, drift in (("A", 24, -0.01), ("B", 24, -0.5), ("C", 2, 0.0)):
        claims.reading = cell
        for n, stay in ((100, 0), (200, large)):
            found = claim.proportion(stay, 24)
            claims.add("stays", "share of runs that stay", found, least=0.5, n=f"{n}")
        found = claim.Interval((drift,) * 3, 24)
        claims.add("shrinks", "drift of the largest jam", found, least=-0.05, n="200")
        found = claim.Interval((0.5, 0.4, 0.6), 48)
        claims.add("longer", "factor of exits", found, most=1.0, n="100, 200")
    found = script.answers({"first": claims}).set_index("cell")["first rule"].to_dict()
    # The largest size counts; a jam that shrinks keeps the answer open.
    assert found == {"A": "for", "B": "open", "C": "against"}


def test_wall_slots() -> None:
    # Six discs of 5 cm touch around a circle of 10 cm; their hulls' bows are 10 cm further out.
    assert transition_runs.outer_radius_cm(6, 1.0) == pytest.approx(20.0)
