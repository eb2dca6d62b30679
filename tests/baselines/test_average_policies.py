"""The mean of leaning laws: what it steers with, and that it holds the provenance of each part."""

from pathlib import Path

import numpy as np
import pytest

from flockenv.policies import HiddenUnits, LeaningLaw, NetworkPolicy, load


def law(gain: float, bias: float, weights: dict[str, float], seed: int) -> LeaningLaw:
    gains = {"gain": gain, "backward_gain": 2.0, "damping": 9.0}
    provenance = {"seed": str(seed), "samples": "100", "wall_s": "7", "command": f"search {seed}"}
    return LeaningLaw(gains, bias, weights, provenance=provenance)


def test_the_mean_of_two(script, tmp_path: Path) -> None:
    law(1.0, 0.1, {"near": 0.2}, 3).save(tmp_path / "one.npz")
    law(4.0, 0.3, {"near": 0.4, "leaders": -1.0}, 4).save(tmp_path / "other.npz")
    out = tmp_path / "new" / "mean.npz"
    script.main([str(tmp_path / "one.npz"), str(tmp_path / "other.npz"), "--out", str(out)])
    mean = load(out)
    assert mean.gains == pytest.approx({"gain": 2.0, "backward_gain": 2.0, "damping": 9.0})
    assert mean.bias == pytest.approx(0.2)
    rest = {name: weight for name, weight in mean.weights.items() if weight}
    assert rest == pytest.approx({"near": 0.3, "leaders": -0.5})
    assert mean.provenance["samples"] == "200"
    assert mean.provenance["seed"] == "3, 4"
    assert mean.provenance["part 1: command"] == "search 4"
    assert "average_policies.py" in mean.provenance["command"]


def test_parts_and_mean_lead_in_episodes_for_training(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    seen = []

    def noted(parameters, policy, seeds, duration_s):
        seen.append((policy.gains["gain"], seeds))
        return {"signed_order": np.full(len(seeds), policy.gains["gain"])}

    monkeypatch.setattr(script, "run_episodes", noted)
    law(1.0, 0.1, {}, 3).save(tmp_path / "one.npz")
    law(4.0, 0.3, {}, 4).save(tmp_path / "other.npz")
    files = [str(tmp_path / "one.npz"), str(tmp_path / "other.npz")]
    out = ["--out", str(tmp_path / "mean.npz")]
    script.main([*files, *out, "--pool", "narrow", "--episodes", "3"])
    assert [gain for gain, _ in seen] == pytest.approx([1.0, 4.0, 2.0, 3.02])
    assert all(seeds == seen[0][1] and min(seeds) >= 2**32 for _, seeds in seen)
    assert "their mean: signed order 2.000 [2.000, 2.000]" in capsys.readouterr().out


def test_only_leaning_laws_have_a_mean(script, tmp_path: Path) -> None:
    NetworkPolicy([np.zeros((67, 1))], [[0.0]]).save(tmp_path / "net.npz")
    law(1.0, 0.1, {}, 0).save(tmp_path / "law.npz")
    with pytest.raises(SystemExit, match="not a leaning law"):
        script.main([str(tmp_path / "law.npz"), str(tmp_path / "net.npz")])
    hidden = HiddenUnits({"near": [0.2]}, [0.0], [0.1])
    LeaningLaw(law(1.0, 0.1, {}, 0).gains, 0.0, {}, hidden=hidden).save(tmp_path / "units.npz")
    with pytest.raises(SystemExit, match="hidden units have no mean"):
        script.main([str(tmp_path / "units.npz"), str(tmp_path / "units.npz")])
    with pytest.raises(SystemExit, match=r"none\.npz"):
        script.main([str(tmp_path / "none.npz"), "--out", str(tmp_path / "mean.npz")])
    assert not (tmp_path / "mean.npz").exists()
