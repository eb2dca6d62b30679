"""`flockenv train` trains, resumes, and names what is missing."""

import json
import signal
import time
import zipfile
from pathlib import Path

import pytest

from flockenv.policies import load

pytest.importorskip("stable_baselines3")

TINY = """
n_boats = 6
pools = ["wide"]
n_leaders = [1, 2]
episode_s = 5.0
control_hz = 2.0
num_flocks = 2
n_steps = 32
batch_size = 32
n_epochs = 1
net_arch = [8]
samples = 192
checkpoint_every = 1
validation_episodes = 2
validation_s = 5.0
device = "cpu"
"""


@pytest.fixture
def tiny(tmp_path: Path) -> str:
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return str(path)


def test_it_trains_and_resumes(cli, tiny: str, tmp_path: Path) -> None:
    out = str(tmp_path / "run")
    arguments = ["--settings", tiny, "--set", "net_arch=[4]", "--seed", "5", "--out", out]
    done = cli("train", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["samples"] == 192
    assert done.stderr == ""
    policy = load(tmp_path / "run" / "best.npz")
    assert policy.weights[0].shape[1] == 4
    assert policy.provenance["seed"] == "5"
    assert "train --settings" in policy.provenance["command"]
    more = cli("train", "--resume", "--samples", "384", "--out", out, "--quiet")
    assert more.returncode == 0, more.stderr
    assert "samples: 384" in more.stdout
    assert "best.npz" in more.stdout


def test_several_seeds_and_a_budget_in_flock_hours(
    cli, tiny: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("flockenv.training.seeds._EPISODE_S", 5.0)
    out = tmp_path / "runs"
    # Two flocks for 16 s.
    hours = str(2 * 16 / 3600)
    arguments = ["--settings", tiny, "--flock-hours", hours, "--seeds", "2", "--episodes", "2"]
    done = cli("train", *arguments, "--out", str(out), "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["flock_hours"] == round(2 * 16 / 3600, 3)
    policies = {row["policy"] for row in found["evaluation"]}
    assert {"seed 0", "seed 1", "all seeds", "tuned damped law"} < policies
    assert load(out / "seed-1" / "best.npz").provenance["seed"] == "1"
    again = cli("train", *arguments, "--out", str(out), "--quiet")
    assert again.returncode == 0, again.stderr
    assert "wide k=2: all seeds minus tuned damped law: " in again.stdout
    for wrong, words in (
        (["--seeds", "2", "--resume"], "the same command resumes"),
        (["--episodes", "4"], "--episodes is not accepted without --seeds"),
        (["--settings", tiny, "--flock-hours", "1", "--samples", "9"], "one or the other"),
        (["--settings", tiny, "--flock-hours", "0"], "flock_hours = 0.0 is not accepted"),
    ):
        refused = cli("train", *wrong, "--out", str(tmp_path / "wrong"))
        assert refused.returncode == 2
        assert words in refused.stderr
    assert not (tmp_path / "wrong").exists()


def test_errors_are_one_line_with_exit_code_2(cli, tiny: str, tmp_path: Path) -> None:
    (tmp_path / "torn.toml").write_text("samples = ")
    (tmp_path / "misspelt.toml").write_text("sample = 3")
    with zipfile.ZipFile(tmp_path / "model.zip", "w") as archive:
        archive.writestr("policy.pth", b"")
    for arguments, words in (
        (["--settings", tiny, "--set", "net_arc=[4]"], "net_arch"),
        (["--settings", tiny, "--set", "start=lore"], "start"),
        (["--settings", tiny, "--set", f"start={tmp_path / 'model.zip'}"], "command line --trust"),
        (["--settings", tiny, "--set", f"start={tmp_path / 'model.zip'}", "--trust"], "no model"),
        (["--settings", str(tmp_path / "none.toml")], "none.toml"),
        (["--settings", str(tmp_path / "torn.toml")], "torn.toml"),
        (["--settings", str(tmp_path / "misspelt.toml")], "misspelt.toml"),
        (["--resume"], "no checkpoint"),
        (["--resume", "--seed", "3"], "only --samples"),
    ):
        done = cli("train", *arguments, "--out", str(tmp_path / "run"))
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert "Traceback" not in done.stderr
        # A policy to start from is read only when training starts.
        assert done.stderr.startswith("Error:") or "start=" in " ".join(arguments)


def test_the_missing_extra_is_named(cli, tmp_path: Path) -> None:
    forbid = "import sys; sys.modules.update(torch=None, stable_baselines3=None)"
    done = cli.process("train", "--out", tmp_path, before=forbid)
    assert done.returncode == 2
    assert "pip install 'flockenv[train]'" in done.stderr


def test_an_interrupt_names_the_command_that_resumes(cli, tiny: str, tmp_path: Path) -> None:
    out = tmp_path / "run"
    arguments = ["--settings", tiny, "--samples", "100000000", "--out", out]
    run = cli.start("train", "--quiet", *arguments)
    deadline = time.monotonic() + 120
    while not (out / "checkpoint.npz").exists():
        assert time.monotonic() < deadline
        assert run.poll() is None
        time.sleep(0.1)
    run.send_signal(signal.SIGINT)
    _, reported = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "--resume" in reported
    assert (out / "checkpoint.npz").exists()
