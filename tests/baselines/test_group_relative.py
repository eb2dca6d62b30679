"""Law: what did better than its group is done more often, up to the bound of a ratio."""

import dataclasses

import numpy as np
import pytest

from flockenv.training.branching import BranchingFlocks


def test_advantages_are_against_the_groups_mean(script):
    settings = dataclasses.replace(script.Settings(), groups=2, size=2)
    # Flocks i and i + 2 are a group: 0.1 and 0.3, and 0.8 and 0.6.
    found = script.advantages(np.array([0.1, 0.8, 0.3, 0.6]), settings)
    np.testing.assert_allclose(found, [-1, 1, 1, -1])


def test_the_gradient_is_that_of_the_clipped_objective(script):
    random = np.random.default_rng(0)
    features, start = random.normal(size=(50, 3)), random.normal(size=3)
    spread, advantage = random.uniform(0.5, 1.0, 50), random.normal(size=50)
    chosen = features @ start + spread * random.normal(size=50)

    def objective(weights):
        before, now = ((chosen - features @ each) / spread for each in (start, weights))
        ratio = np.exp((before**2 - now**2) / 2)
        return np.minimum(advantage * ratio, advantage * ratio.clip(0.8, 1.2)).mean()

    for weights in (start, start + 0.05, start + np.array([0.3, -0.2, 0.1])):
        found = script.ascent(weights, chosen, features, spread, start, advantage, 0.2)
        steps = 1e-6 * np.eye(3)
        numeric = [(objective(weights + s) - objective(weights - s)) / 2e-6 for s in steps]
        np.testing.assert_allclose(found, numeric, atol=1e-6)


def test_a_branch_has_what_its_leaders_saw(script):
    flocks = BranchingFlocks("wide", groups=2, size=3, branch_s=8, episode_s=16, seed=0)
    weights = np.zeros((6, 30))
    weights[4:, -1] = 1.0
    orders, seen = script.branch(weights, flocks, 4)
    assert seen.shape == (8, 6, 3, 29)
    assert (seen[0, ::2] == seen[0, 0]).all()
    assert (orders[4:] != orders[:2]).any()
    assert (orders[2:4] == orders[:2]).all()


def test_it_learns_which_way_to_lean(script, monkeypatch: pytest.MonkeyPatch):
    def branch(candidates, flocks, judged_s):
        """Return orders that count the lean that a bias adds."""
        seen = np.zeros((3, len(candidates), 1, candidates.shape[1] - 1))
        return -np.square(candidates[:, -1] - 0.5), seen

    monkeypatch.setattr(script, "branch", branch)
    settings = dataclasses.replace(script.Settings(), branch_s=3, learning_rate=5e-3)
    weights, _ = script.train(settings, 0, 128 * 3 * 60 / 3600)
    assert weights[-1] == pytest.approx(0.5, abs=0.05)
    assert not weights[:-1].any()


def test_a_training_is_repeated_by_its_seed_and_its_file_steers(
    script, assert_repeats, monkeypatch
):
    small = dataclasses.replace(script.Settings(), groups=2, size=2, branch_s=8, judged_s=4)
    monkeypatch.setattr(script, "Settings", lambda: small)
    arguments = ["--flock-hours", str(3 * 4 * 8 / 3600)]
    assert_repeats(arguments)
