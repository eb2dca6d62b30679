"""Law: a seed says what a training is."""

import pytest

from studies.levels import level_curves

pytest.importorskip("torch")
pytest.importorskip("sb3_contrib")


def test_trainings_with_another_seed_differ_and_with_one_do_not(script) -> None:
    def weights(seed):
        policy, _, seeds = script.evolution(
            "order-easy", 2.2, seed, script.Curve("order-easy", 2.2)
        )
        return policy.weights[0].tolist(), seeds

    (first, met), (again, _), (other, others) = weights(3), weights(3), weights(4)
    assert first == again != other
    assert met[-1] < others[0]


def test_looking_at_a_training_changes_nothing(script, monkeypatch) -> None:
    monkeypatch.setattr(level_curves, "POINT_S", 480.0)

    def weights(*, looks: bool) -> list[float]:
        curve = script.Curve("order-easy", 1.1)
        if not looks:
            curve.look = lambda hours, learned: None
        policy, done, _ = script.baselines3("a2c", "order-easy", 1.1, 0, curve)
        assert len(curve.points) == (4 if looks else 0)
        return [done, *policy.weights[0].ravel()]

    assert weights(looks=True) == weights(looks=False)
