"""Law: the script writes the actor that it trained as a policy, the same one from the same seed."""

import csv

import numpy as np
import pytest

torch = pytest.importorskip("torch")

import flockenv  # noqa: E402 - after the check above
from flockenv.policies import load  # noqa: E402

SHORT = ["--samples", "640", "--flocks", "8"]


def test_a_short_run_is_repeatable(script, tmp_path):
    for name in ("first", "second"):
        script.main([*SHORT, "--seed", "3", "--out", str(tmp_path / name)])
    first, second = (load(tmp_path / name / "policy.npz") for name in ("first", "second"))
    assert first.digest == second.digest
    assert first.provenance["seed"] == "3"
    assert first.action_mode == "lean"
    with (tmp_path / "first" / "curve.csv").open(encoding="utf-8") as file:
        assert [row["samples"] for row in csv.DictReader(file)] == ["320", "640"]
    script.main(["--samples", "0", "--seed", "3", "--flocks", "8", "--out", str(tmp_path)])
    untrained = load(tmp_path / "policy.npz")
    assert untrained.digest != first.digest
    assert [len(bias) for bias in untrained.biases] == [64, 64, 1]


def test_advantages_of_an_episode_that_is_cut_off(script):
    """Where values are 0, an advantage is what follows of the rewards, discounted."""
    settings = script.Settings(flocks=3, steps=25, gae_lambda=1.0, gamma=0.9)
    env = flockenv.LeadersVectorEnv(3, autoreset_mode="disabled", **script.OPTIONS)
    learner = script.Learner(settings, env)
    for each in learner.critic.parameters():
        torch.nn.init.zeros_(each)
    observations, _ = env.reset(seed=1)
    twin = env.clone()
    rollout, _, mean = script.rollout_of(env, learner, observations)
    rewards = np.zeros((25, 3))
    ends = []
    for step, actions in enumerate(rollout["actions"].reshape(25, 3, 2).numpy()):
        _, rewards[step], _, truncated, _ = twin.step(actions)
        ends.append(bool(truncated[0]))
        if truncated.any():
            twin.reset(options={"reset_mask": truncated})
    # Twenty decisions of 2 s make an episode of 40 s.
    assert np.flatnonzero(ends).tolist() == [19]
    assert mean == pytest.approx(rewards.mean(), rel=1e-5)
    expected = np.zeros((25, 3))
    for part in (slice(0, 20), slice(20, 25)):
        later = np.zeros(3)
        for step in reversed(range(25)[part]):
            later = rewards[step] + 0.9 * later
            expected[step] = later
    returns = rollout["returns"].reshape(25, 3).numpy()
    np.testing.assert_allclose(returns, expected, rtol=1e-4, atol=1e-6)


def test_an_update_favors_what_was_better(script):
    settings = script.Settings(flocks=4, steps=1, epochs=20, minibatches=1)
    env = flockenv.LeadersVectorEnv(4, autoreset_mode="disabled", **script.OPTIONS)
    torch.manual_seed(0)
    learner = script.Learner(settings, env)
    observations, _ = env.reset(seed=2)
    seen = torch.from_numpy(observations)
    actions = torch.tensor([[0.5, 0.5], [-0.5, -0.5]] * 2)
    with torch.no_grad():
        before = learner.actions(seen)
        rollout = {
            "observations": seen,
            "features": torch.from_numpy(env.flock_features()),
            "actions": actions,
            "log_probs": before.log_prob(actions),
            "advantages": torch.tensor([1.0, -1.0, 1.0, -1.0]),
            "returns": torch.full((4,), 0.7),
        }
    learner.update(rollout)
    with torch.no_grad():
        gain = learner.actions(seen).log_prob(actions) - rollout["log_probs"]
        value = learner.values(rollout["features"])
    assert (gain[0::2] > 0).all()
    assert (gain[1::2] < 0).all()
    assert (value - 0.7).abs().max() < 0.3
