"""Law: every command explains itself in 80 columns, refuses nonsense, and keeps whole files."""

import json
import os
import signal
import subprocess
import sys

import pandas as pd
import pytest

import flockenv
from flockenv.cli import app
from flockenv.cli.presets import ABOUT
from flockenv.comparison import episodes
from flockenv.policies import Policy
from flockenv.runs import store

COMMANDS = sorted(command.callback.__name__ for command in app.registered_commands)
SPEC = "minutes = 600\nseeds = 40\n[[grid]]\nn_boats = [20]\n"


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example_and_fits(cli, name):
    reported = cli.succeeds(name, "-h")
    assert f"Example: flockenv {name}" in reported.stdout
    assert "--json" in reported.stdout
    assert max(map(len, reported.stdout.splitlines())) <= 80


def test_the_package_is_the_command_line():
    words = [sys.executable, "-m", "flockenv", "--version"]
    assert subprocess.check_output(words, text=True, timeout=60).strip() == flockenv.__version__


def test_presets_in_80_columns(cli):
    reported = cli("presets").stdout
    assert max(map(len, reported.splitlines())) <= 80
    for name, about in ABOUT.items():
        assert f"{name}: {about}" in " ".join(reported.split())
    assert "experiment: 1.106 (fitted to Section 4" in " ".join(reported.split())


def test_presets_as_json_are_the_presets(cli):
    reported = json.loads(cli("presets", "--json").stdout)
    assert list(reported) == flockenv.FlockParameters.presets()
    for name, preset in reported.items():
        values = {field: each["value"] for field, each in preset["fields"].items()}
        assert flockenv.FlockParameters.from_dict(values) == flockenv.FlockParameters.preset(name)
        assert all(each["source"] and each["meaning"] for each in preset["fields"].values())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "--jason"], "--jason"),
        (["run", "--set", "n_bots=3"], "did you mean 'n_boats'"),
        (["run", "--policy", "{}/none.npz"], "none.npz: No such file or directory"),
        (["run", "--policy", "{}/file.npz"], "file.npz"),
        (["run", "--out", "{}/run.txt"], ".npz"),
        (["run", "--out", "{}/file.npz/run.npz"], "cannot be written"),
        (["run", "--out", "{}/file.npz"], "--force overwrites it"),
        (["run", "--hz", "0"], "sample_hz"),
        (["run", "--params", "{}/none.toml"], "cannot be read"),
        (["replay", "{}/none.npz"], "cannot be read"),
        (["replay", "{}/file.npz"], "file.npz"),
        (["replay", "{}/file.npz", "--html", "{}/page.png"], ".html"),
        (["replay", "{}/file.npz", "--gif", "{}/page.png"], ".gif"),
        (
            ["replay", "{}/file.npz", "--mp4", "{}/a.mp4", "--html", "{}/a.html"],
            "--html is not accepted",
        ),
        (["replay", "{}/file.npz", "--speed", "3"], "--speed is not accepted with a page"),
        (["replay", "{}/file.npz", "--colors", "role", "--html", "{}/a.html"], "--colors is not"),
        (["replay", "{}/file.npz", "--gif", "{}/a.gif", "--open"], "--open is not accepted with"),
        (["demo", "--out", "{}/page.png"], "--out page.png is not accepted"),
        (["run", "--set", "BW_S=0.3"], "did you mean 'bw_s'"),
        (["replay", "{}/file.npz", "--name", "a", "--name", "b"], "2 --name for 1 recordings"),
        (["sweep", "{}/none.toml"], "cannot be read"),
        (["sweep", "{}/spec.toml", "--out", "{}/file.npz/out"], "cannot be written"),
        (["sweep", "{}/spec.toml", "--engine", "lokal"], "local"),
        (["sweep", "{}/spec.toml", "--shard", "half"], "such as 3/8"),
    ],
)
def test_errors_are_one_line_with_exit_code_2(cli, arguments, words, tmp_path, monkeypatch):
    (tmp_path / "file.npz").write_bytes(b"PK\5\6" + bytes(18))
    (tmp_path / "spec.toml").write_text(SPEC)
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(tmp_path)
    done = cli(*(each.replace("{}", ".") for each in arguments))
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr
    assert [path for path in sorted(tmp_path.rglob("*")) if path.is_file()] == before


@pytest.mark.parametrize("package", ["pandas", "matplotlib", "scipy"])
def test_a_missing_extra_is_named_before_any_work(cli, package, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    done = cli("compare", "--out", tmp_path / "a")
    assert done.returncode == 2
    assert f"{package} is not installed: pip install '.[plot]' in a clone" in done.stderr
    assert not (tmp_path / "a").exists()


@pytest.fixture
def pressed_in(monkeypatch):
    """Let Ctrl-C come once, when a function is called."""

    def patched(owner, name):
        work, presses = getattr(owner, name), iter([signal.SIGINT])

        def pressed(*arguments, **options):
            for number in presses:
                signal.raise_signal(number)
            return work(*arguments, **options)

        monkeypatch.setattr(owner, name, pressed)

    return patched


EPISODES = ["compare", "--episodes", "2", "--minutes", "9", "--set", "n_boats=5"]


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["run"], (sys.modules["flockenv.cli.run"], "simulate")),
        (EPISODES, (episodes.Episodes, "measure")),
        ([*EPISODES, "--n-leaders", "1"], (Policy, "decide")),
    ],
)
def test_ctrl_c_leaves_no_half_result(cli, arguments, place, tmp_path, pressed_in):
    pressed_in(*place)
    done = cli(*arguments, "--out", tmp_path / "sub" / "out.npz")
    assert done.returncode == 130, done.stderr
    assert "Interrupted. Nothing of it is stored." in done.stderr
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_ctrl_c_keeps_what_a_comparison_has_finished(cli, tmp_path, monkeypatch):
    """Pressed in the second of eight parts: the first one is there as a whole comparison has it."""
    measure, calls = episodes.Episodes.measure, []

    def pressed(*arguments, **options):
        calls.append(1)
        if len(calls) == 2:
            signal.raise_signal(signal.SIGINT)
        return measure(*arguments, **options)

    words = [*EPISODES[:3], "--set", "n_boats=5", "--n-leaders", "1-2", "--minutes", "0.2"]
    words += ["--quiet", "--out"]
    monkeypatch.setattr(episodes.Episodes, "measure", pressed)
    done = cli(*words, tmp_path / "part")
    assert done.returncode == 130, done.stderr
    words_of_it = "part holds what was finished: 1 pair of a policy and a number of leaders."
    assert words_of_it in done.stderr.replace("\n", " ")
    monkeypatch.undo()
    cli.succeeds(*words, tmp_path / "whole")
    part, whole = (pd.read_csv(tmp_path / each / "runs.csv") for each in ("part", "whole"))
    assert part.equals(whole[: len(part)])
    assert len(part) == 2
    assert "interrupted = true" in (tmp_path / "part" / "run.toml").read_text()
    assert "interrupted" not in (tmp_path / "whole" / "run.toml").read_text()
    assert not list(tmp_path.rglob("*.tmp"))


def test_ctrl_c_keeps_the_runs_of_a_sweep(cli, tmp_path, pressed_in):
    spec, out = tmp_path / "spec.toml", tmp_path / "out"
    spec.write_text("minutes = 0.1\nseeds = 9\n[[grid]]\nn_boats = [3]\n")
    pressed_in(store, "execute")
    done = cli("sweep", spec, "--workers", "1", "--out", out)
    assert done.returncode == 130, done.stderr
    assert "are stored in" in done.stderr
    assert len(list(out.rglob("*.npz"))) == 1
    cli.succeeds("sweep", spec, "--out", out)
    assert len(list(out.rglob("*.npz"))) == 9


def test_ctrl_c_amid_a_file_leaves_it_whole(cli, tmp_path, pressed_in):
    pressed_in(os, "fsync")
    out = tmp_path / "run.npz"
    done = cli("run", "--minutes", "0.1", "--set", "n_boats=4", "--out", out)
    assert (done.returncode, done.stdout.count("Written to")) == (130, 1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.npz", "run.toml"]
    assert len(flockenv.Recording.load(out)) == 61
