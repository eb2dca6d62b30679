"""`flockenv train` trains, resumes, compares, and names what is wrong or missing."""

import json
import re
import signal
from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

from flockenv.policies import load

TINY = [
    *("--n-leaders", "2", "--set", "n_boats=6", "--set", "episode_s=16.0"),
    *("--set", "decision_period_s=1.0"),
    *("--ppo", "n_steps=16", "--ppo", "batch_size=32"),
    *("--flock-hours", str(128 * 32 / 3600), "--episodes", "2"),
]


@pytest.fixture(autouse=True)
def _short_comparisons(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("flockenv.training.ppo.curve._EPISODE_S", 8.0)


def test_it_trains_resumes_and_compares(cli, tmp_path: Path) -> None:
    out = str(tmp_path / "run")
    done = cli.succeeds("train", *TINY, "--seed", "5", "--out", out, "--json")
    assert done.stderr == ""
    found = json.loads(done.stdout)
    assert set(found["signed_order"]) == {"paper's law", "tuned law", "trained"}
    assert load(found["model"], trust=True).provenance["samples"] == str(128 * 32 * 2)
    gain, low, high = found["gain"]
    orders = found["signed_order"]
    assert gain == pytest.approx(orders["trained"] - orders["tuned law"])
    assert low <= gain <= high
    assert len((tmp_path / "run" / "comparison.csv").read_text().splitlines()) == 1 + 3 * 2
    assert (tmp_path / "run" / "curve.png").stat().st_size > 0
    # As if the boats of one episode had overlapped.
    episodes = tmp_path / "run" / "0.monitor.csv"
    rows = episodes.read_text().splitlines()
    columns = rows[1].split(",")
    assert columns[-2:] == ["worst_overlap_cm", "unsolved"]
    assert all(float(row.split(",")[-2]) <= 1e-4 for row in rows[2:])
    rows[2] = ",".join([*rows[2].split(",")[:-2], "0.0314", "2"])
    episodes.write_text("\n".join(rows) + "\n")
    hours = str(128 * 48 / 3600)
    more = cli.succeeds(
        "train", "--resume", "--flock-hours", hours, "--episodes", "2", "--out", out
    )
    assert f"Resuming from {out}/checkpoint.zip" in more.stderr.replace("\n", "")
    assert "trained: signed order " in more.stdout
    assert "trained minus tuned law: " in more.stdout
    (line,) = (line for line in more.stdout.splitlines() if "tolerance_cm" in line)
    assert re.fullmatch(
        r"1 of \d+ episodes of the training left overlaps deeper than tolerance_cm; the deepest is "
        r"0\.031 cm",
        line,
    )
    assert load(found["model"], trust=True).provenance["samples"] == str(128 * 48 * 2)


def test_errors_are_one_line_with_exit_code_2(cli, tmp_path: Path) -> None:
    for arguments, words in (
        (["--pool", "deep"], "pool = 'deep' is not accepted: wide or narrow"),
        (["--set", "n_boat=6"], "n_boat"),
        (["--set", "bw_s=abc"], "bw_s must be a number"),
        (["--ppo", "gama=0.9"], "did you mean 'gamma'"),
        (["--flock-hours", "0"], "flock_hours = 0.0 is not accepted"),
        (["--resume"], "no checkpoint"),
        (["--resume", "--seed", "3"], "only --flock-hours may differ"),
    ):
        done = cli("train", *arguments, "--out", tmp_path / "run")
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert "Error:" in done.stderr
        assert not (tmp_path / "run").exists()


def test_the_missing_extra_is_named(cli, tmp_path: Path) -> None:
    forbid = "import sys; sys.modules.update(torch=None, stable_baselines3=None)"
    done = cli.process("train", "--out", tmp_path, before=forbid)
    assert done.returncode == 2
    assert "pip install '.[train]' in a clone" in done.stderr


def test_an_interrupt_leaves_a_checkpoint(
    cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from stable_baselines3 import PPO

    # Amid the first update.
    update, calls = PPO.train, []

    def pressed(self: PPO) -> None:
        calls.append(1)
        if len(calls) == 1:
            signal.raise_signal(signal.SIGINT)
        update(self)

    monkeypatch.setattr(PPO, "train", pressed)
    out = tmp_path / "run"
    done = cli("train", *TINY, "--quiet", "--out", out)
    assert done.returncode == 130
    assert f"Interrupted. {out} holds the last checkpoint: --resume continues" in done.stderr
    monkeypatch.undo()
    assert {path.name for path in out.iterdir()} >= {"checkpoint.zip", "settings.toml"}
    assert not list(out.glob("*.tmp"))
