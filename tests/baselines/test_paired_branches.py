"""Law: both flocks of a pair have one state and one noise, and a search is its seed's alone."""

import dataclasses

import numpy as np
import pytest

from flockenv.policies import load


@pytest.fixture
def small(script):
    return dataclasses.replace(script.Settings(), pairs=4, branch_s=8, judged_s=4, episode_s=16)


def test_flocks_of_a_pair_differ_by_their_weights_alone(script, small):
    pairs = script.Pairs(small, seed=0)
    weights = np.zeros((8, 30))
    found = []
    for _ in range(4):  # Two branches of an episode, a start at rest in between.
        orders = pairs.branch(weights)
        assert (orders[:4] == orders[4:]).all()
        assert len(set(orders[:4])) == 4
        found.append(orders)
    weights[4:, -1] = 1.0
    assert (np.array(found)[1:] != np.array(found)[:-1]).all()
    others = pairs.branch(weights)
    assert (others[:4] != others[4:]).all()


def test_pairs_start_at_rest_in_turn(script, small):
    pairs = script.Pairs(small, seed=0)
    assert [pairs._had.tolist() for _ in range(2) if pairs.branch(np.zeros((8, 30))).any()] == [
        [1, 2, 1, 2],
        [2, 1, 2, 1],
    ]


def test_a_search_is_repeated_by_its_seed_and_its_file_steers(script, tmp_path, monkeypatch):
    small = dataclasses.replace(script.Settings(), pairs=2, branch_s=16, judged_s=8, episode_s=32)
    monkeypatch.setattr(script, "Settings", lambda **given: dataclasses.replace(small, **given))
    arguments = ["--flock-hours", str(3 * 4 * 16 / 3600)]
    for folder, seed in (("a", "3"), ("b", "3"), ("c", "4")):
        script.main([*arguments, "--seed", seed, "--out", str(tmp_path / folder)])
    one, same, other = (
        load(tmp_path / folder / seed / "policy.json")
        for folder, seed in (("a", "3"), ("b", "3"), ("c", "4"))
    )
    assert one.weights == same.weights != other.weights
    assert any(one.weights.values())
    assert (tmp_path / "a/3/curve.csv").read_text().count("\n") == 4
