"""Law: the learning check runs through every interface, and says so when nothing was learned."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")


def test_a_short_run_of_each_interface(script, tmp_path):
    out = tmp_path / "docs" / "check.md"
    arguments = ["--samples", "500", "--episodes", "4", "--out", str(out)]
    failed = script.main(arguments)
    page = out.read_text()
    count = len(script.INTERFACES)
    assert failed == (f"learns through {count} of the {count} interfaces" not in page)
    for interface in script.INTERFACES:
        assert f"| {interface} |" in page
    assert "baselines/learning_check.py --samples 500" in page


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
