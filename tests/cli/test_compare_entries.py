"""Law: an entry scored again has the same row to the digit, and a broken one loses nobody's row."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tomli_w

from flockenv.comparison.episodes import run_episodes
from flockenv.comparison.levels import LEVELS
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy

LEVEL = "order-easy"


def write_entry(folder: Path, name: str, levels: dict[str, list[str]]) -> str:
    values = {"suite": "v3", "name": name, "class": "by hand"}
    values |= {"link": "here", "flock_hours": 30.0, "training_seeds": [2**32, 2**32]}
    path = folder / f"{name}.toml"
    path.write_text(tomli_w.dumps({**values, "levels": levels}), "utf-8")
    return str(path)


@pytest.fixture
def entry(tmp_path: Path) -> str:
    layout = {"observation": LEVELS[LEVEL].observation, "mirror_to_target": True}
    size = len(observation_entries(layout["observation"]))
    for place, seed in enumerate((0, 1)):
        weights = np.random.default_rng(seed).normal(size=(size, 1))
        NetworkPolicy([weights], [[0.1]], **layout).save(tmp_path / f"{place}.npz")
    return write_entry(tmp_path, "mine", {LEVEL: ["0.npz", "1.npz"]})


def words(*entries: str, out: Path) -> list[str]:
    named = [word for each in entries for word in ("--entry", each)]
    return ["compare", "--suite", "v3", *named, "--trial-flocks", "3", "--out", str(out)]


def test_an_entry_is_scored_again_to_the_digit(cli, entry: str, tmp_path: Path) -> None:
    done = cli.succeeds(*words(entry, out=tmp_path / "first"))
    assert done.stdout.startswith("order-easy, 30 flock-hours, mine: ")
    assert "A trial: rows of the table are of 512 flocks, not 3" in done.stderr
    other = ["--entry", write_entry(tmp_path, "same", {LEVEL: ["1.npz", "0.npz"]})]
    cli.succeeds(*words(entry, out=tmp_path / "again"), *other)
    first, again = (pd.read_csv(tmp_path / name / "entries.csv") for name in ("first", "again"))
    assert len(again) == 2
    found = again[again["entry"] == "mine"].reset_index(drop=True)
    pd.testing.assert_frame_equal(found, first, check_exact=True)
    orders = pd.read_csv(tmp_path / "first" / "orders.csv")
    own = orders[orders["entry"] == "mine"]
    assert own["signed_order"].mean() == pytest.approx(first["signed_order"][0], rel=1e-4)
    printed = json.loads(cli.succeeds(*words(entry, out=tmp_path / "json"), "--json").stdout)
    assert printed["entries"][0]["entry"] == "mine"


def deep(*arguments):
    overlaps = {"unsolved": np.array([0, 7, 0]), "worst_overlap_cm": np.array([0.0, 0.25, 0.0])}
    return run_episodes(*arguments) | overlaps


def overlap_warning(out: Path) -> str:
    line = "4 of 12 episodes left overlaps deeper than tolerance_cm; the deepest is 0.25 cm"
    return f"Warning: {line}; {out / 'orders.csv'} says which\n"


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_overlaps_beyond_the_tolerance_are_said_in_one_line(
    cli, entry: str, tmp_path: Path, monkeypatch, form
) -> None:
    """The second flock of each policy is deep: here of two policies and of two references."""
    monkeypatch.setattr("flockenv.comparison.levels.run_episodes", deep)
    done = cli.succeeds(*words(entry, out=tmp_path), *form)
    assert done.stderr.count(overlap_warning(tmp_path)) == 1
    assert not form or json.loads(done.stdout)["entries"]
    flocks = pd.read_csv(tmp_path / "orders.csv")
    assert flocks["unsolved"].tolist() == [0, 7, 0] * 4
    assert flocks["worst_overlap_cm"].max() == 0.25


def test_ctrl_c_keeps_finished_rows_and_their_warning(
    cli, entry: str, tmp_path: Path, monkeypatch
) -> None:
    """It comes in the second entry: after two references and the two policies of the first."""
    runs = []

    def stopped(*arguments):
        runs.append(arguments)
        if len(runs) > 4:
            raise KeyboardInterrupt
        return deep(*arguments)

    monkeypatch.setattr("flockenv.comparison.levels.run_episodes", stopped)
    other = write_entry(tmp_path, "other", {LEVEL: ["0.npz"]})
    done = cli(*words(entry, other, out=tmp_path))
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr.count(overlap_warning(tmp_path)) == 1
    assert f"Interrupted. {tmp_path / 'entries.csv'} holds the rows" in done.stderr
    assert pd.read_csv(tmp_path / "entries.csv")["entry"].tolist() == ["mine"]


def test_ctrl_c_during_the_references_names_no_file(
    cli, entry: str, tmp_path: Path, monkeypatch
) -> None:
    def stopped(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("flockenv.comparison.levels.run_episodes", stopped)
    done = cli(*words(entry, out=tmp_path / "out"))
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr.endswith("Interrupted. Nothing of it is stored.\n")
    assert not (tmp_path / "out" / "entries.csv").exists()


BROKEN = """
class Broken:
    def predict(self, seen, state=None):
        return [0.0], state
"""


@pytest.mark.parametrize("levels", [["order-easy"], ["order-easy", "order-noisy"]])
@pytest.mark.parametrize("comes_first", [False, True])
def test_a_broken_entry_loses_no_other_row(
    cli, entry: str, tmp_path: Path, monkeypatch, levels, comes_first
) -> None:
    """It breaks in the last of its levels, and has no row of the one before either."""
    (tmp_path / "broken_policy.py").write_text(BROKEN, "utf-8")
    monkeypatch.chdir(tmp_path)
    *good, bad = levels
    policies = {**{level: ["0.npz"] for level in good}, bad: ["broken_policy:Broken"]}
    broken = write_entry(tmp_path, "broken", policies)
    named = (broken, entry) if comes_first else (entry, broken)
    done = cli(*words(*named, out=tmp_path / "out"), "--trust")
    assert done.returncode == 1
    assert f"Not scored: broken, {bad}, broken_policy:Broken: what a policy re" in done.stderr
    assert done.stdout.startswith("order-easy, 30 flock-hours, mine: ")
    assert pd.read_csv(tmp_path / "out" / "entries.csv")["entry"].tolist() == ["mine"]
    assert set(pd.read_csv(tmp_path / "out" / "orders.csv")["entry"]) == {"reference", "mine"}


def test_a_broken_entry_alone_writes_nothing(cli, entry: str, tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "broken_policy.py").write_text(BROKEN, "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("flockenv.comparison.levels.run_episodes", deep)
    broken = write_entry(tmp_path, "broken", {LEVEL: ["broken_policy:Broken"]})
    done = cli(*words(broken, out=tmp_path / "out"), "--trust")
    assert (done.returncode, done.stdout) == (1, "")
    assert "Warning" not in done.stderr
    assert not (tmp_path / "out" / "entries.csv").exists()


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (["--suite", "v3"], "--suite v3 scores entries"),
        (["--suite", "v3", "--policy", "learned"], "--policy is not accepted with --suite v3"),
        (["--suite", "v3", "--n-leaders", "3"], "--n-leaders is not accepted with --suite v3"),
        (["--suite", "v2", "--entry", "{}"], "--entry is not accepted without --suite v3"),
        (["--trial-flocks", "9"], "--trial-flocks is not accepted without --suite v3"),
        (["--suite", "v3", "--entry", "{}", "--trial-flocks", "513"], "at most 512"),
        (
            ["--suite", "v3", "--entry", "{}", "--task", "camera"],
            "'camera' is not a level of suite",
        ),
        (["--suite", "v3", "--entry", "{}", "--task", "order-wide"], "no entry has a policy"),
        (["--suite", "v3", "--entry", "{}", "--entry", "{}"], "two entries are called mine"),
        (["--suite", "v3", "--entry", "none.toml"], "none.toml cannot be read"),
        (["--suite", "v4"], "suite = 'v4' is not accepted"),
    ],
)
def test_errors_come_before_anything_is_written(cli, entry, given, expected, tmp_path) -> None:
    done = cli("compare", *(each.replace("{}", entry) for each in given), "--out", tmp_path / "o")
    assert done.returncode == 2
    assert expected in done.stderr.replace("\n", " ")
    assert not (tmp_path / "o" / "entries.csv").exists()
