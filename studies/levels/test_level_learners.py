"""Law: a seed says what a training is."""

import pytest

pytest.importorskip("torch")
pytest.importorskip("sb3_contrib")


def test_trainings_with_another_seed_differ_and_with_one_do_not(script) -> None:
    def weights(seed):
        policy, _, seeds = script.evolution("order-easy", 2.2, seed)
        return policy.weights[0].tolist(), seeds

    (first, met), (again, _), (other, others) = weights(3), weights(3), weights(4)
    assert first == again != other
    assert met[-1] < others[0]
