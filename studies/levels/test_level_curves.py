"""Law: a curve is what was learned by then, and its area the mean of its scores."""

import pandas as pd
import pytest


def test_a_curve_has_five_points_of_what_was_learned_by_then(script, monkeypatch) -> None:
    monkeypatch.setattr(script, "POINT_S", 480.0)
    curve = script.Curve("order-easy", 10.0)
    for hours in (1.0, 2.5, 3.0, 7.0, 7.5, 9.9, 10.0, 10.1):
        curve.look(hours, lambda: "straight ahead")
    curve.add(10.1, "damped law")
    hours, orders = zip(*curve.points, strict=True)
    assert hours == (2.5, 7.0, 7.5, 9.9, 10.1)
    assert len({*orders[:4]}) == 1
    assert orders[4] > orders[0] + 0.1


def test_an_area_is_the_mean_of_a_curves_scores(script) -> None:
    curve = script.Curve("order-easy", 10.0, points=[(5.0, 0.1), (10.1, 0.3)])

    class Training:
        given, provenance = "a.npz", curve.texts()

    class Without:
        given, provenance = "b.npz", {}

    class Entry:
        name, budget, trainings = "mine", "30", {"order-easy": (Training, Without)}

    ends = {"straight ahead": 0.1, "damped law": 0.5}
    reference = pd.DataFrame({"policy": ends.keys(), "signed_order": ends.values()})
    reference = reference.assign(level="order-easy", entry="reference")
    # Flocks that no curve met have another scale.
    others = reference.assign(flock=script.flocks_of("order-easy"), signed_order=[0.0, 9.0])
    found = script.points([Entry], pd.concat([reference.assign(flock=0), others]))
    assert found["policy"].tolist() == ["a.npz", "a.npz"]
    assert found["flock_hours"].tolist() == [5.0, 10.1]
    assert found["score"].tolist() == pytest.approx([0.0, 0.5])
    (row,) = script.areas(found).to_dict("records")
    assert row["area"] == pytest.approx(0.25)
    assert row["trainings"] == 1


def test_areas_stand_by_level_and_budget_the_best_first(script) -> None:
    rows = [
        ("order-noisy", "30", "a", 0.9), ("order-easy", "100", "a", 0.1),
        ("order-easy", "30", "a", 0.2), ("order-easy", "30", "b", 0.3),
    ]  # fmt: skip
    curves = pd.DataFrame(rows, columns=["level", "budget", "entry", "score"]).assign(policy="0")
    found = script.areas(curves)
    assert found["area"].tolist() == [0.3, 0.2, 0.1, 0.9]


def test_points_of_all_levels_take_as_long(script) -> None:
    assert [script.flocks_of(level) for level in script.LEVELS] == [128, 128, 64, 32]
