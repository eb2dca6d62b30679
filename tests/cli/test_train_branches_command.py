"""`flockenv train --algorithm branches` needs nothing but the package, and goes on where it was."""

import json
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from flockenv.cli import train_branches
from flockenv.cli.parameters import changed_fields

TINY = [
    *("--algorithm", "branches", "--pool", "narrow", "--n-boats", "6", "--n-leaders", "2"),
    *("--set", "pairs=2", "--set", "branch_s=32", "--set", "hold_s=8", "--set", "trial_s=16"),
    *("--episodes", "2"),
]
ALONE = """
import sys
for name in ("torch", "stable_baselines3", "pandas", "scipy", "matplotlib", "filelock"):
    sys.modules[name] = None
from flockenv.cli import main
from flockenv.training import branches
branches._EPISODE_S = 8.0
main()
"""


@pytest.fixture(autouse=True)
def _short_comparisons(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("flockenv.training.branches._EPISODE_S", 8.0)


def test_it_needs_no_other_package_and_resumes_to_the_same_policy(cli, tmp_path: Path) -> None:
    out = tmp_path / "alone"
    arguments = ["train", *TINY, "--flock-hours", "0.07", "--seed", "3", "--out", str(out)]
    done = subprocess.run(
        [sys.executable, "-c", ALONE, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "trained minus tuned law: " in done.stdout
    assert not (out / "curve.png").exists()
    assert len((out / "curve.csv").read_text().splitlines()) == 1 + 2
    assert len((out / "comparison.csv").read_text().splitlines()) == 1 + 2

    half = tmp_path / "half"
    cli.succeeds("train", *TINY, "--flock-hours", "0.03", "--seed", "3", "--out", half)
    more = ["--resume", "--flock-hours", "0.07", "--episodes", "2", "--json", "--out", half]
    found = json.loads(cli.succeeds("train", "--algorithm", "branches", *more).stdout)
    assert set(found["signed_order"]) == {"paper's law", "tuned law", "trained"}
    assert (half / "curve.png").stat().st_size > 0
    policies = [json.loads((folder / "policy.json").read_text()) for folder in (out, half)]
    assert policies[0]["weights"] == policies[1]["weights"]
    assert policies[0]["provenance"]["command"] == (
        "flockenv train --algorithm branches --pool narrow --n-leaders 2 --flock-hours 0.07 "
        "--seed 3 --set pairs=2 --set branch_s=32 --set hold_s=8 --set trial_s=16 --set n_boats=6"
    )


def test_the_stored_command_has_the_same_settings() -> None:
    changes = ["leaders_reverse=false", "bw_s=0.3", "target=cw,ccw", "action_mode=rudder"]
    settings = {"seed": 3, "environment": changed_fields(changes)}
    words = shlex.split(train_branches._command(settings))
    assert words[:6] == ["flockenv", "train", "--algorithm", "branches", "--seed", "3"]
    assert words[6::2] == ["--set"] * 4
    assert changed_fields(words[7::2]) == settings["environment"]


def test_an_interrupt_says_that_resume_goes_on(
    cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = train_branches._lines
    press = lambda progress: signal.raise_signal(signal.SIGINT)  # noqa: E731 - after a round
    monkeypatch.setattr(train_branches, "_lines", lambda is_quiet: press)
    out = tmp_path / "run"
    done = cli("train", *TINY, "--flock-hours", "5", "--out", out)
    assert done.returncode == 130
    assert f"Interrupted. {out} holds the last checkpoint: --resume continues" in done.stderr
    monkeypatch.setattr(train_branches, "_lines", lines)
    more = ["--algorithm", "branches", "--resume", "--flock-hours", "0.03", "--episodes", "2"]
    cli.succeeds("train", *more, "--out", out)


def test_overlaps_beyond_the_tolerance_are_said_in_one_line(
    cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = ["train", *TINY, "--flock-hours", "0.03"]
    assert "tolerance" not in cli.succeeds(*options, "--out", tmp_path / "none").stdout
    overlaps = property(lambda training: (2, 1, 0.0314))
    monkeypatch.setattr("flockenv.training.branches.BranchTraining.overlaps", overlaps)
    said = cli.succeeds(*options, "--out", tmp_path / "some").stdout.splitlines()
    assert said[-2] == (
        "1 of 2 branches of the training left overlaps deeper than tolerance_cm; the deepest is "
        "0.031 cm"
    )


def test_overlaps_of_the_comparison_are_said_in_one_line(
    cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compared(*given: object) -> dict[str, dict[str, np.ndarray]]:
        found = compare_with_laws(*given)
        # A deep overlap that the solver knows of, and a deeper one that it was allowed.
        found["trained"]["unsolved"][:] = [3, 0]
        found["trained"]["worst_overlap_cm"][:] = [0.0314, 1.0]
        return found

    compare_with_laws = train_branches.compare_with_laws
    monkeypatch.setattr(train_branches, "compare_with_laws", compared)
    said = cli.succeeds("train", *TINY, "--flock-hours", "0.03", "--out", tmp_path / "some").stdout
    assert said.splitlines()[-2] == (
        "1 of 6 episodes left overlaps deeper than tolerance_cm; the deepest is 0.031 cm"
    )


def test_errors_are_one_line_with_exit_code_2(cli, tmp_path: Path) -> None:
    for arguments, words in (
        (["--algorithm", "branch"], "'branch' is not an algorithm"),
        (["--algorithm", "branches", "--flock-hours", "0"], "flock_hours = 0"),
        (["--algorithm", "branches", "--set", "holds=8"], "did you mean 'hold_s'"),
        (["--algorithm", "branches", "--set", "bw_s=abc"], "Error: bw_s must be a number"),
        (["--algorithm", "branches", "--ppo", "gamma=0.9"], "--ppo is for --algorithm ppo"),
        (["--algorithm", "branches", "--resume"], "no checkpoint of branches"),
        (["--algorithm", "branches", "--resume", "--seed", "3"], "only --flock-hours may differ"),
    ):
        done = cli("train", *arguments, "--out", tmp_path / "run")
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert not (tmp_path / "run").exists()
