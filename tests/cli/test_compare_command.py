"""`flockenv compare` prints and writes what it measured, and refuses nonsense in words."""

import json
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv.cli.compare_options import REFERENCES
from flockenv.comparison.figure import policy_colors
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy

BRIEF = ["--episodes", "3", "--minutes", "0.5", "--leaders", "0-1"]
SHORT = [*BRIEF, "--set", "n_boats=8"]
NARROW = [*SHORT, "--pool", "narrow"]


def learned(folder: Path, name: str = "leaning.npz") -> str:
    size = len(observation_entries())
    made = {"command": "by hand", "seed": "7"}
    NetworkPolicy([np.zeros((size, 1))], [[0.25]], provenance=made).save(folder / name)
    return str(folder / name)


def test_a_table_of_ten_rows_and_the_files(cli, tmp_path: Path, colors_in) -> None:
    done = cli("compare", *SHORT[:-4], "--leaders", "0-4", *SHORT[-2:], "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    numbers = [each for each in rows if "±" in " ".join(each)]
    assert [row[0] for row in numbers if row[0].startswith(("wide", "narrow"))] == [
        "wide-bw-0.31",
        "narrow-bw-0.45",
    ]
    assert len(numbers) - 1 == 10, "one row per pool and number of leaders, and the caption"
    assert colors_in(tmp_path / "leader_curve.png") == {*policy_colors(REFERENCES).values()}
    assert {each.name for each in tmp_path.iterdir()} == {
        "differences.csv",
        "leader_curve.png",
        "lines.csv",
        "means.csv",
        "narrow-bw-0.45.toml",
        "run.toml",
        "runs.csv",
        "wide-bw-0.31.toml",
    }


def test_regressions_and_differences_are_printed_if_asked_for(cli, tmp_path: Path) -> None:
    out = ["--out", str(tmp_path)]
    assert "F = " not in cli("compare", *NARROW, *out).stdout
    full = cli("compare", *NARROW, "--full", *out).stdout
    assert "narrow-bw-0.45, learned: signed_order = " in full
    assert f"narrow-bw-0.45, learned minus {REFERENCES[1]}, k = 1: " in full


def test_ones_own_policy_comes_first_and_has_a_card(cli, tmp_path: Path, colors_in) -> None:
    arguments = ["--leaders", "2", "--bw-s", "0.2", "--bw-s", "0.4", "--out", str(tmp_path)]
    words = ["compare", "--policy", learned(tmp_path), "--name", "mine", *NARROW, *arguments]
    done = cli(*words, "--json")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    found = json.loads(done.stdout)
    cases = ["narrow-bw-0.2", "narrow-bw-0.4"]
    policies = ["mine", *REFERENCES]
    assert [(row["case"], row["policy"]) for row in found["means"]] == [
        (case, policy) for case in cases for policy in policies
    ]
    assert all(row["psi_o_low"] <= row["psi_o"] <= row["psi_o_high"] for row in found["means"])
    first = found["differences"][0]
    assert (first["policy"], first["reference"], first["n"]) == ("mine", REFERENCES[0], 3)
    card = (tmp_path / "card.md").read_text("utf-8")
    assert card.startswith("# mine\n")
    for text in ("by hand", *cases, f"| {REFERENCES[1]} | 2 |", "3 episodes of 30 s"):
        assert text in card
    run = tomllib.loads((tmp_path / "run.toml").read_text("utf-8"))
    assert run["command"] == shlex.join(["flockenv", *words, "--json"])
    assert run["cases"]["narrow-bw-0.2"]["seeds"] == {"first": 0, "number": 3}
    stored = (tmp_path / "narrow-bw-0.2.toml").read_text("utf-8")
    assert flockenv.FlockParameters.from_toml(stored).bw_s == 0.2


def test_alternating_targets_and_drop_outs(cli, tmp_path: Path) -> None:
    environment = ["--env", "target=alternate", "--env", "dropout_rate=0.01"]
    out = ["--leaders", "1", "--json", "--out", str(tmp_path)]
    two = ["--only", "--policy", "damped law", "--policy", "straight ahead"]
    done = cli("compare", *two, *NARROW, *environment, *out)
    assert done.returncode == 0, done.stderr
    assert "alternating targets, 1 % of positions dropped" in (tmp_path / "card.md").read_text()
    (row,) = json.loads(done.stdout)["differences"]
    assert (row["policy"], row["reference"], row["n"]) == ("damped law", "straight ahead", 3)
    assert row["low"] <= row["mean"] <= row["high"]


def test_a_policy_that_is_a_reference_is_run_once(cli, tmp_path: Path) -> None:
    arguments = ["--policy", REFERENCES[2], "--leaders", "1", "--json", "--out", str(tmp_path)]
    done = cli("compare", *NARROW, *arguments)
    assert done.returncode == 0, done.stderr
    policies = [row["policy"] for row in json.loads(done.stdout)["means"]]
    assert policies == [REFERENCES[2], *REFERENCES[:2]]


def test_a_file_called_like_a_reference_is_not_it(cli, tmp_path: Path) -> None:
    file = learned(tmp_path, "learned.npz")
    arguments = ["--policy", file, "--leaders", "1", "--json", "--out", str(tmp_path)]
    done = cli("compare", *NARROW, *arguments)
    assert done.returncode == 0, done.stderr
    first = json.loads(done.stdout)["differences"][0]
    assert (first["policy"], first["reference"]) == (file, "learned")


def test_a_policy_for_each_leader(cli, tmp_path: Path) -> None:
    """Leaders of which each has the same policy are leaders with that policy."""
    pair = "leader_0=damped law,leader_1=damped law"
    two = ["--only", "--policy", pair, "--name", "pair", "--policy", "damped law", "--name", "one"]
    out = ["--leaders", "2", "--json", "--out", str(tmp_path)]
    done = cli("compare", *two, *NARROW, *out)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["differences"]
    assert (row["policy"], row["mean"]) == ("pair", 0.0)


def test_too_short_for_a_frame_in_the_window_is_written_as_unknown(cli, tmp_path: Path) -> None:
    short = ["--episodes", "2", "--minutes", "0.01", "--set", "n_boats=8", "--pool", "narrow"]
    done = cli("compare", *short, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "runs.csv").read_text().splitlines()
    assert lines[0].split(",")[:6] == ["case", "policy", "leaders", "seed", "psi_o", "signed_order"]
    assert len(lines) == 1 + 2 * (1 + 4 * len(REFERENCES))


def test_a_pool_that_nothing_was_made_for(cli, tmp_path: Path) -> None:
    arguments = ["--set", "pool=[90.0, 30.0]", "--set", "bw_s=0.3", "--out", str(tmp_path)]
    done = cli("compare", *SHORT, *arguments, "--quiet")
    assert done.returncode == 0, done.stderr
    assert "Left out, learned: pool = (90.0, 30.0)" in done.stderr
    assert REFERENCES[2] in done.stdout
    assert "tuned" not in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "n_boats=2000"], "do not fit"),
        (["--preset", "simulaton"], "simulation"),
        (["--set", "target=left"], "ccw"),
        (["--set", "target=cw,ccw"], "one target"),
        (["--set", "bw_s=-1"], "bw_s"),
        (["--policy", "dampd law"], "did you mean 'damped law'"),
        (["--policy", "damped law", "--policy", "damped law"], "given twice"),
        (["--policy", "damped law", "--name", "a", "--name", "b"], "2 times for 1"),
        (["--bw-s", "0.31", "--bw-s", "0.3100000001"], "beside 0.31"),
        (["--policy", "{}/broken.npz"], "broken.npz"),
        (["--policy", "{}/missing.npz"], "missing.npz"),
        (["--only"], "without --policy"),
        (["--leaders", "3-1"], "as in 0-4 or 1,3"),
        (["--leaders", "0-99999999"], "at most 64"),
        (["--leaders", "0,1", "--env", "dropout_rate=0.1"], "options dropout_rate"),
        (["--env", "dropout=0.1"], "did you mean 'dropout_rate'"),
        (["--policy", "leader_0=damped law"], "2 leaders are not accepted"),
        (["--policy", "leader_0=damped law,leader_2=learned"], "leader_0, leader_1, in this"),
        (["--policy", "leader_0:learned"], "as in leader_0=mine.npz"),
        (["--task", "reversal"], "without --suite"),
    ],
)
def test_errors_are_one_line_with_exit_code_2(
    cli, arguments: list[str], words: str, tmp_path: Path
) -> None:
    (tmp_path / "broken.npz").write_bytes(b"PK nothing")
    given = [each.replace("{}", str(tmp_path)) for each in arguments]
    out = ["--pool", "narrow", "--out", str(tmp_path / "out")]
    brief = [*BRIEF[:4], "--leaders", "1,2", *out]
    done = cli("compare", *brief, *given)
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--suite", "v1"], "there is v2"),
        (["--suite", "v2", "--task", "reversl"], "did you mean 'reversal'"),
        (["--suite", "v2", "--policy", "{}/leaning.npz"], "flock_hours are missing"),
        (["--suite", "v2", "--policy", "{}/leaning.npz", "--flock-hours", "1e5"], "from 0 to"),
        (["--suite", "v2", "--pool", "narrow"], "--pool is not accepted with --suite v2"),
        (["--suite", "v2", "--set", "n_boats=9"], "--set is not accepted with --suite v2"),
        (["--flock-hours", "3"], "without --suite"),
    ],
)
def test_a_suite_is_not_altered(cli, arguments: list[str], words: str, tmp_path: Path) -> None:
    learned(tmp_path)
    given = [each.replace("{}", str(tmp_path)) for each in arguments]
    done = cli("compare", *given, "--out", str(tmp_path / "out"))
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.replace("\n", " ")
    assert not (tmp_path / "out").exists()
