"""Law: the learning check runs through every interface, and says so when nothing was learned."""

import re

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")


def test_a_short_run_of_each_interface(script, tmp_path):
    out = tmp_path / "docs" / "check.md"
    arguments = ["--samples", "500", "--episodes", "4", "--out", str(out)]
    script.main(arguments)
    page = out.read_text()
    # 500 samples take one rollout of 128 steps: of 16 flocks, or of their 32 leaders.
    for interface, samples in (("parallel", 4096), ("single", 2048), ("vector", 2048)):
        assert f"| {interface} | {samples} |" in page
    rows = (re.search(rf"\| {each} .* s \| (.*)", page)[1] for each in ("single", "vector"))
    assert len({*rows}) == 1, "the same samples teach the same policy"
    assert "baselines/learning_check.py --samples 500" in page


@pytest.mark.parametrize("learned", [(), ("vector",), ("parallel", "single", "vector")])
def test_the_verdict_counts_the_interfaces_that_learned(script, tmp_path, monkeypatch, learned):
    values = np.random.default_rng(0).uniform(0.0, 0.1, 8)

    def known(interface, episodes, act):
        zeros = np.zeros((episodes, 4), np.float32)
        is_random = act(zeros, np.random.default_rng(0)).std() > 0
        return values + (interface in learned and not is_random)

    class Model:
        num_timesteps = 500

        def predict(self, rows, deterministic):
            return np.zeros((len(rows), 1), np.float32), None

    monkeypatch.setattr(script, "train", lambda *_: (Model(), 1.0))
    monkeypatch.setattr(script, "mean_rewards", known)
    out = tmp_path / "check.md"
    assert script.main(["--out", str(out)]) == (len(learned) < 3)
    page = out.read_text()
    assert f"learns through {len(learned)} of the 3 interfaces" in page
    for interface in script.INTERFACES:
        row = next(line for line in page.splitlines() if line.startswith(f"| {interface} "))
        assert row.endswith("| yes |" if interface in learned else "| no |")


def test_interfaces_start_the_same_from_the_same_training_seed(script):
    (seed,) = script.POLICY_SEEDS["learning check"].seeds(1)
    for make in script.INTERFACES.values():
        env = make()
        env.seed(seed)
        first = env.reset()
        assert np.isfinite(first).all()
        env.seed(seed)
        np.testing.assert_array_equal(env.reset(), first)
        env.seed(0)
        assert (env.reset() != first).any()


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_every_interface_learns(script, tmp_path):
    assert script.main(["--out", str(tmp_path / "check.md")]) == 0
