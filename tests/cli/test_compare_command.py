"""`flockenv compare` prints and writes what it measured, and refuses nonsense in words."""

import json
import re
import shlex
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.cli.compare_plan import REFERENCES
from flockenv.comparison.case import Case
from flockenv.comparison.suite import TASKS
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy

BRIEF = ["--episodes", "3", "--minutes", "0.5"]
UP_TO_ONE = ["--n-leaders", "0-1"]
SHORT = [*BRIEF, "--set", "n_boats=8"]
NARROW = [*SHORT, "--pool", "narrow"]


def learned(folder: Path, name: str = "leaning.npz") -> str:
    size = len(observation_entries())
    made = {"command": "by hand", "seed": "7"}
    NetworkPolicy([np.zeros((size, 1))], [[0.25]], provenance=made).save(folder / name)
    return str(folder / name)


def test_a_table_of_five_rows_a_pool_and_the_files(cli, tmp_path: Path, colors_in) -> None:
    both = ["--pool", "wide", "--pool", "narrow"]
    done = cli.succeeds("compare", *SHORT, *both, "--n-leaders", "0-4", "--out", tmp_path)
    assert "F = " not in done.stdout
    rows = [line.split() for line in done.stdout.splitlines()]
    numbers = [each for each in rows if "±" in " ".join(each)]
    cases = [row[0] for row in numbers if row[0].startswith(("wide", "narrow"))]
    # Flocks without leaders are those of every policy.
    _, *cells = next(row[1:] for row in numbers if row[1] == "0")
    assert cells[:2] == cells[2:4] == cells[4:]
    assert cases == ["wide-bw-0.31", "narrow-bw-0.45"]
    assert len(numbers) - 1 == 10, "one row per pool and number of leaders, and the caption"
    assert colors_in(tmp_path / "leader_curve.png") == {*REFERENCES}
    tables = {f"{name}.csv" for name in ("runs", "means", "differences", "lines")}
    toml = {f"{name}.toml" for name in ("run", *cases)}
    assert {each.name for each in tmp_path.iterdir()} == {*tables, *toml, "leader_curve.png"}


def test_the_default_noise_says_of_how_many_boats_it_is(cli, tmp_path: Path) -> None:
    words = ["compare", *BRIEF, *UP_TO_ONE, "--only", "--policy", "straight ahead"]
    words += ["--out", str(tmp_path)]
    eight = ["--set", "n_boats=8"]
    said = "8 boats at the critical noise of 27, since theirs is not stored"
    assert said in cli.succeeds(*words, *eight).stderr.replace("\n", " ")
    for others in ([], [*eight, "--bw-s", "0.2"], [*eight, "--quiet"]):
        assert "critical noise" not in cli.succeeds(*words, *others).stderr


def test_ones_own_policy_comes_first_and_has_a_card(cli, tmp_path: Path) -> None:
    arguments = ["--n-leaders", "1,2", "--bw-s", "0.2", "--bw-s", "0.4", "--out", str(tmp_path)]
    words = ["compare", "--policy", learned(tmp_path), "--name", "mine", *SHORT, *arguments]
    done = cli.succeeds(*words, "--full")
    assert done.stderr == ""
    assert "wide-bw-0.2, learned: signed_order = " in done.stdout
    assert f"wide-bw-0.4, mine minus {REFERENCES[0]}, k = 2: " in done.stdout
    card = (tmp_path / "card.md").read_text("utf-8")
    assert card.startswith("# mine\n")
    for text in ("by hand", "wide-bw-0.4", f"mine minus {REFERENCES[1]}", "3 episodes of 30 s"):
        assert text in card
    run = tomllib.loads((tmp_path / "run.toml").read_text("utf-8"))
    assert run["command"] == shlex.join(["flockenv", *words, "--full"])
    assert run["cases"]["wide-bw-0.2"]["seeds"] == {"first": 0, "number": 3}
    stored = (tmp_path / "wide-bw-0.2.toml").read_text("utf-8")
    assert flockenv.FlockParameters.from_toml(stored).bw_s == 0.2


def test_saved_parameters_compare_the_same_again(cli, tmp_path: Path) -> None:
    first = cli("compare", *NARROW, *UP_TO_ONE, "--json", "--out", tmp_path / "a")
    found = json.loads(first.stdout)
    means = [(row["policy"], row["leaders"]) for row in found["means"]]
    assert means == [("no leaders", 0), *((name, 1) for name in REFERENCES[1:])]
    assert all(row["psi_o_low"] <= row["psi_o"] <= row["psi_o_high"] for row in found["means"])
    row = found["differences"][0]
    assert (row["policy"], row["reference"], row["n"]) == (*REFERENCES[1:], 3)
    params = tmp_path / "a" / "narrow-bw-0.45.toml"
    assert flockenv.FlockParameters.from_toml(params.read_text()).pool == "narrow"
    again = cli(
        "compare", "--params", params, *BRIEF, *UP_TO_ONE, "--json", "--out", tmp_path / "b"
    )
    assert json.loads(again.stdout) == found


def test_alternating_targets_and_drop_outs_in_a_pool_of_ones_own(cli, tmp_path: Path) -> None:
    environment = ["--env", "target=alternate", "--env", "dropout_rate=0.01"]
    pool = ["--set", "pool=[150, 30]", "--set", "bw_s=0.2"]
    two = ["--only", "--policy", "damped law", "--policy", "straight ahead"]
    out = ["--n-leaders", "1", "--json", "--out", str(tmp_path)]
    done = cli.succeeds("compare", *two, *SHORT, *pool, *environment, *out)
    card = (tmp_path / "card.md").read_text()
    assert "150x30-bw-0.2: 8 boats, pool (150.0, 30.0), bw_s = 0.2, target = alternate" in card
    (row,) = json.loads(done.stdout)["differences"]
    assert (row["policy"], row["reference"], row["n"]) == ("damped law", "straight ahead", 3)
    assert row["low"] <= row["mean"] <= row["high"]


def test_names_of_references(cli, tmp_path: Path) -> None:
    """A policy that is one is run once under any name; a file that is called like one is not."""
    file = learned(tmp_path, "learned.npz")
    two = ["--policy", REFERENCES[2], "--policy", file, "--n-leaders", "1", "--json"]
    done = cli.succeeds("compare", *SHORT, *two, "--out", tmp_path)
    policies = [row["policy"] for row in json.loads(done.stdout)["means"]]
    assert policies == [REFERENCES[2], file, *REFERENCES[:2]]
    alias = ["--policy", REFERENCES[1], "--name", "mine", "--n-leaders", "1", "--json"]
    done = cli("compare", *SHORT, *alias, "--out", tmp_path)
    policies = [row["policy"] for row in json.loads(done.stdout)["means"]]
    assert policies == ["mine", REFERENCES[0], REFERENCES[2]]


def test_a_policy_for_each_leader(cli, tmp_path: Path) -> None:
    """Leaders of which each has the same policy are leaders with that policy."""
    pair = "leader_0=damped law,leader_1=damped law"
    two = ["--only", "--policy", pair, "--name", "pair", "--policy", "damped law", "--name", "one"]
    out = ["--n-leaders", "2", "--json", "--out", str(tmp_path)]
    done = cli.succeeds("compare", *two, *NARROW, *out)
    (row,) = json.loads(done.stdout)["differences"]
    assert (row["policy"], row["mean"]) == ("pair", pytest.approx(0.0, abs=1e-9))


@pytest.mark.parametrize("form", [[], ["--full"], ["--json"]])
def test_overlaps_beyond_the_tolerance_are_said_in_one_line(cli, tmp_path: Path, form) -> None:
    """Boats as fast as bullets are more than a substep and its halves can take apart."""
    bullets = ["--set", "speed_cm_s=50000", "--set", "dt_s=0.1", "--bw-s", "0.3"]
    words = ["compare", *SHORT, "--n-leaders", "0", *bullets, *form, "--out", str(tmp_path)]
    said = cli.succeeds(*words).stderr.replace("\n", " ")
    runs = pd.read_csv(tmp_path / "runs.csv")
    deep = runs[runs["unsolved"] > 0]
    assert len(deep)
    assert said.count(f"{len(deep)} of {len(runs)} episodes left overlaps deeper than") == 1


def test_too_short_for_a_frame_in_the_window_is_written_as_unknown(cli, tmp_path: Path) -> None:
    short = ["--episodes", "2", "--minutes", "0.01", "--set", "n_boats=8", "--pool", "narrow"]
    done = cli.succeeds("compare", *short, "--full", "--out", tmp_path)
    assert "unknown" in done.stdout
    assert "nan" not in done.stdout
    lines = (tmp_path / "runs.csv").read_text().splitlines()
    assert lines[0].split(",")[:6] == ["case", "policy", "leaders", "seed", "psi_o", "signed_order"]
    assert "Left out, learned: pool = narrow" in done.stderr
    assert len(lines) == 1 + 2 * (1 + 4 * len({*REFERENCES} - {"learned"}))


def test_a_pool_that_nothing_was_made_for(cli, tmp_path: Path) -> None:
    arguments = ["--pool", "(90, 30)", "--set", "bw_s=0.3", "--out", str(tmp_path)]
    own = ["--policy", "damped law"]
    done = cli.succeeds("compare", *SHORT, *UP_TO_ONE, *arguments, *own, "--quiet")
    assert "Left out, learned: pool = (90.0, 30.0)" in done.stderr
    assert "Left out, tuned law: pool = (90.0, 30.0)" in done.stderr
    assert REFERENCES[2] in done.stdout
    assert "damped law" in done.stdout
    assert "tuned" not in done.stdout


def test_a_table_in_80_columns(cli, tmp_path: Path) -> None:
    own = tmp_path / "a_policy_with_a_rather_long_name_of_its_own.json"
    flockenv.policies.load("learned", pool="wide").save(own)
    done = cli("compare", *SHORT, *UP_TO_ONE, "-q", "--out", tmp_path / "out", "--policy", own)
    table, _ = done.stdout.split("Written to")
    assert max(map(len, table.splitlines())) <= 80
    assert "…" not in table


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "n_boats=2000"], "do not fit"),
        (["--set", "n_boats=2"], "--n-leaders and --n-boats"),
        (["--set", "n_leaders=3"], "--set n_leaders is not accepted: use --n-leaders"),
        (["--set", "target=cw,ccw"], "one target"),
        (["--pool", "(90, 10)"], "--bw-s 1.0`"),
        (["--policy", "damped law", "--policy", "damped law"], "given twice"),
        (["--policy", "damped law", "--name", "a", "--name", "b"], "2 --name for 1 --policy"),
        (["--policy", "damped law", "--name", "learned"], "another policy has this name"),
        (["--policy", "damped law", "--name", "no leaders"], "is not a name for a policy"),
        (["--policy", "{}/broken.npz"], "broken.npz"),
        (["--policy", "{}/missing.npz"], "missing.npz"),
        (["--only"], "without --policy"),
        (["--policy", "damped law", "--n-leaders", "0"], "nobody is steered"),
        (["--n-leaders", "3-1"], "as in 0-4 or 1,3"),
        (["--n-leaders", "0-99999999"], "at most 64"),
        (["--n-leaders", "0,1", "--env", "dropout_rate=0.1"], "takes no dropout_rate"),
        (["--env", "dropout=0.1"], "did you mean 'dropout_rate'"),
        (["--policy", "leader_0=damped law,leader_2=learned"], "for each of leader_0, leader_1"),
        (["--policy", "leader_0:learned"], "NAME=VALUE"),
        (["--policy", "leader_0=3"], "'3' is not a policy"),
        (["--suite", "v2", "--policy", "leader_0=3"], "'3' is not a policy"),
        (["--task", "reversal"], "without --suite"),
        (["--suite", "v1"], "there are v2 and v3"),
        (["--suite", "v2", "--task", "reversl"], "did you mean 'reversal'"),
        (["--suite", "v2", "--bw-s", "1"], "--bw-s is not accepted with --suite v2"),
        (["--suite", "v2", "--set", "n_boats=9"], "--set is not accepted with --suite v2"),
        (
            ["--suite", "v2", "--policy", "mine.npz"],
            "0 --flock-hours for 1 --policy of a file (mine)",
        ),
        (["--suite", "v2", "--policy", "learned", "--flock-hours", "9"], "1 --flock-hours for 0"),
        (["--policy", "learned", "--flock-hours", "9"], "--flock-hours is not accepted without"),
    ],
)
def test_errors_are_one_line_with_exit_code_2(
    cli, arguments: list[str], words: str, tmp_path: Path
) -> None:
    (tmp_path / "broken.npz").write_bytes(b"PK nothing")
    given = [each.replace("{}", str(tmp_path)) for each in arguments]
    brief = [] if "--suite" in arguments else ["--minutes", "0.5"]
    brief += [] if {"--suite", "--n-leaders"} & {*arguments} else ["--n-leaders", "1,2"]
    done = cli("compare", *brief, *given, "--out", tmp_path / "out")
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out" / "runs.csv").exists()


def test_a_suite_says_first_how_long_it_takes(cli, tmp_path, monkeypatch):
    short = [replace(task, seeds=task.seeds[:2], episode_s=20.0) for task in TASKS[:2]]
    monkeypatch.setattr("flockenv.cli.compare_plan.tasks_named", lambda *_: short)
    before = []
    run = Case.run
    monkeypatch.setattr(
        Case, "run", lambda case, *rest: before.append(case.episode_s) or run(case, *rest)
    )
    mine = ["--policy", learned(tmp_path, "mine.npz"), "--flock-hours", "160"]
    words = ["compare", "--suite", "v2", *mine, "--policy", "straight ahead", "--out", tmp_path]
    done = cli.succeeds(*words)
    assert re.search(r"^2 tasks, 0 flock-hours: about \d+ min here$", done.stderr, re.MULTILINE)
    # A minute of each policy, and then the tasks.
    assert before == [60.0, 60.0, 60.0, 20.0, 20.0]
    spent = pd.read_csv(tmp_path / "scores.csv").groupby("policy")["flock_hours"].first()
    assert spent["mine"] == 160.0
    assert np.isnan(spent["straight ahead"])
    assert "min here" not in cli(*words, "--quiet").stderr
