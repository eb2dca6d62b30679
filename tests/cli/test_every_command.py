"""Law: every command explains itself in 80 columns, refuses nonsense, and says where work is."""

import dataclasses
import json
import os
import pty
import signal
import subprocess
import sys

import pytest

import flockenv
from flockenv.cli import app
from flockenv.cli.presets import ABOUT
from flockenv.comparison import episodes
from flockenv.runs import store

COMMANDS = sorted(command.callback.__name__ for command in app.registered_commands)
SPEC = """
minutes = 600
seeds = 40
[[grid]]
n_boats = [20]
"""
TINY = ["--episodes", "2", "--minutes", "0.2", "--set", "n_boats=5"]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example_and_fits(cli, name):
    reported = cli(name, "--help")
    assert reported.returncode == 0
    assert f"Example: flockenv {name}" in reported.stdout
    assert max(map(len, reported.stdout.splitlines())) <= 80


@pytest.mark.parametrize("name", sorted({*COMMANDS} - {"presets"}))
def test_work_can_be_quiet_and_machine_readable(cli, name):
    options = cli(name, "--help").stdout
    for option in ("--json", "--quiet", "-q", "--html" if name == "replay" else "--out"):
        assert option in options
    assert "--seed" in options or name in ("replay", "sweep", "analyze")


@pytest.mark.parametrize("arguments", [[], ["run"]])
def test_help_is_also_called_h(cli, arguments):
    assert cli(*arguments, "-h").stdout == cli(*arguments, "--help").stdout != ""


def test_the_package_is_the_command_line():
    words = [sys.executable, "-m", "flockenv", "--version"]
    assert subprocess.check_output(words, text=True, timeout=60).strip() == flockenv.__version__


def test_no_bar_is_left_above_an_error(cli, tmp_path):
    """On a terminal, the bar's last line is cleared before the error is printed."""
    terminal, own = pty.openpty()
    fails = (
        "import sys, flockenv.cli\n"
        "from flockenv.errors import ParameterError\n"
        "def simulate(*a, **k): raise ParameterError('in the middle')\n"
        "sys.modules['flockenv.cli.run'].simulate = simulate\n"
    )
    arguments = ["run", "--out", tmp_path / "a.npz"]
    process = cli.start(*arguments, before=fails, stderr=own, COLUMNS="100", TERM="xterm")
    os.close(own)
    printed = everything(terminal)
    os.close(terminal)
    assert process.wait(timeout=60) == 2
    bar, error = printed.rindex("left:"), printed.index("in the middle")
    assert "\x1b[2K" in printed[bar:error], "the line of the bar is erased"


@pytest.mark.parametrize("name", COMMANDS)
def test_misspelt_options_are_reported_with_exit_code_2(cli, name):
    reported = cli(name, "--jason")
    assert reported.returncode == 2
    assert "--jason" in reported.stderr


def test_presets_in_80_columns(cli):
    reported = cli("presets")
    assert reported.returncode == 0
    assert max(map(len, reported.stdout.splitlines())) <= 100
    assert "…" not in reported.stdout
    for name, about in ABOUT.items():
        assert f"{name}: {about}" in reported.stdout
    for words in ("gyration_radius_cm", "4.74", "experiment: fitted to Section 4", "Section 5.2"):
        assert words in reported.stdout
    text = " ".join(reported.stdout.split())
    for field in dataclasses.fields(flockenv.FlockParameters):
        assert field.metadata["doc"] in text
        assert field.metadata["unit"] in text


def test_presets_as_json_are_the_presets(cli):
    reported = json.loads(cli("presets", "--json").stdout)
    assert list(reported) == list(ABOUT) == flockenv.FlockParameters.presets()
    for name, preset in reported.items():
        values = {field: each["value"] for field, each in preset["fields"].items()}
        assert flockenv.FlockParameters.from_dict(values) == flockenv.FlockParameters.preset(name)
        assert all(each["source"] and each["meaning"] for each in preset["fields"].values())
        assert preset["fields"]["speed_cm_s"]["unit"] == "cm/s"


@pytest.mark.parametrize(
    ("variable", "line", "words"),
    [
        ("complete_bash", "flockenv re", ["replay"]),
        ("complete_zsh", "flockenv comp", ["compare"]),
        ("complete_fish", "flockenv ana", ["analyze"]),
        ("complete_bash", "flockenv run --see", ["--seed"]),
    ],
)
def test_shells_complete(cli, variable, line, words):
    environment = {
        "_FLOCKENV_COMPLETE": variable,
        "_TYPER_COMPLETE_ARGS": line,
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(line.split()) - 1),
    }
    done = cli.process(before="import sys; sys.argv[0] = 'flockenv'", **environment)
    assert all(word in done.stdout for word in words), (done.stdout, done.stderr)
    assert "sweep" not in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["compare", "--set", "n_bots=3"], "did you mean 'n_boats'"),
        (["compare", "--set", "n_leaders=3"], "numbers of leaders are --leaders"),
        (["compare", "--params", "{}/none.toml"], "cannot be read"),
        (["compare", "--params", "{}/wall.toml", "--pool", "wide"], "contradicts"),
        (["compare", "--set", "pool=[90, 10]"], "`--set bw_s=1.0`"),
        (["compare", "--set", "n_boats=4"], "fewer `--leaders`"),
        (["compare", "--out", "{}/file/out"], "cannot be written"),
        (["compare", "--set", "bw_s=1", "--bw-s", "2"], "--bw-s contradicts"),
        (["sweep", "{}/none.toml"], "cannot be read"),
        (["sweep", "{}/spec.toml", "--out", "{}/file/out"], "cannot be written"),
        (["sweep", "{}/spec.toml", "--engine", "lokal"], "local"),
        (["run", "--out", "{}/file/run.npz"], "cannot be written"),
        (["replay", "{}/file"], "file"),
    ],
)
def test_errors_are_one_line_with_exit_code_2(cli, arguments, words, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("here already")
    (tmp_path / "spec.toml").write_text(SPEC)
    (tmp_path / "wall.toml").write_text('pool = "narrow"\n')
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(tmp_path)
    done = cli(*(a.replace("{}", ".") for a in arguments))
    assert done.returncode == 2, done.stderr
    assert words in done.stderr.replace("\n", " ")
    assert sorted(tmp_path.rglob("*")) == before


def test_saved_parameters_compare_the_same_again(cli, tmp_path):
    first = cli("compare", "--pool", "narrow", *TINY, "--json", "--out", tmp_path / "a")
    assert first.returncode == 0, first.stderr
    params = tmp_path / "a" / "narrow-bw-0.45.toml"
    parameters = flockenv.FlockParameters.from_toml(params.read_text())
    assert (parameters.n_boats, parameters.pool) == (5, "narrow")
    assert parameters.bw_s == flockenv.FlockParameters.critical_bw_s("simulation", "narrow")
    again = cli("compare", "--params", params, *TINY[:4], "--json", "--out", tmp_path / "b")
    assert json.loads(again.stdout) == json.loads(first.stdout)


def test_a_pool_of_ones_own(cli, tmp_path):
    parameters = ["--set", "pool=[150, 30]", "--set", "bw_s=0.2", "--set", "target=ccw"]
    arguments = ["--only", "--leaders", "1", "--json", "--out", tmp_path]
    done = cli("compare", "--policy", "damped law", *parameters, *TINY, *arguments)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["means"]
    assert row["case"] == "150x30-bw-0.2"
    text = (tmp_path / "150x30-bw-0.2.toml").read_text()
    assert flockenv.FlockParameters.from_toml(text).target == "ccw"


def test_a_table_in_80_columns(cli, tmp_path):
    own = tmp_path / "a_policy_with_a_rather_long_name_of_its_own.json"
    flockenv.policies.load("learned", pool="narrow").save(own)
    for columns in ("80", "200"):
        words = ["compare", *TINY, "-q", "--out", tmp_path / "out", "--policy", str(own)]
        done = cli(*words, COLUMNS=columns)
        assert done.stderr == ""
        table, _ = done.stdout.split("Written to")
        assert max(map(len, table.splitlines())) <= int(columns)
        assert "…" not in table


def test_a_sweep_keeps_what_was_asked_beside_its_table(cli, tmp_path):
    (tmp_path / "small.toml").write_text("minutes = 0.1\nseeds = 1\n[[grid]]\nn_boats = [3]\n")
    done = cli("sweep", tmp_path / "small.toml", "--out", tmp_path / "out", "-q")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "sweep.toml").read_bytes() == (tmp_path / "small.toml").read_bytes()


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


EPISODES = ["--episodes", "2", "--minutes", "9", "--set", "n_boats=5"]
NO_LEADERS = episodes, "simulate"
STEPPED = flockenv.LeadersVectorEnv, "step"
#: Where Ctrl-C comes, what is written before, and what is said.
AT_WORK = [
    (["run"], (sys.modules["flockenv.cli.run"], "simulate"), "Nothing was written."),
    (["compare", "--pool", "narrow", *EPISODES], NO_LEADERS, "Nothing was written."),
    (["compare", "--pool", "narrow", *EPISODES], STEPPED, "Nothing was written."),
]


@pytest.mark.parametrize(("arguments", "place", "said"), AT_WORK)
def test_ctrl_c_says_what_became_of_the_work(cli, arguments, place, said, tmp_path, pressed_in):
    pressed_in(*place)
    out = tmp_path / "sub" / "out.npz"
    done = cli(*arguments, "--out", out, FORCE_COLOR="1")
    assert done.returncode == 130, done.stderr
    assert f"Interrupted. {said}" in done.stderr
    assert "left:" in done.stderr, "the bar stays"
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_ctrl_c_keeps_the_runs_of_a_sweep(cli, tmp_path, pressed_in):
    spec, out = tmp_path / "spec.toml", tmp_path / "out"
    spec.write_text("minutes = 0.1\nseeds = 9\n[[grid]]\nn_boats = [3]\n")
    pressed_in(store, "execute")
    done = cli("sweep", spec, "--workers", "1", "--out", out)
    assert done.returncode == 130, done.stderr
    assert f"Interrupted. Finished runs are stored in {out / 'runs'}: " in done.stderr
    assert len(list(out.rglob("*.npz"))) == 1
    assert cli("sweep", spec, "--out", out).returncode == 0
    assert len(list(out.rglob("*.npz"))) == 9


def test_ctrl_c_amid_a_file_leaves_it_whole(cli, tmp_path, pressed_in):
    pressed_in(os, "fsync")
    out = tmp_path / "run.npz"
    done = cli("run", "--minutes", "0.1", "--set", "n_boats=4", "--out", out)
    assert (done.returncode, done.stdout.count("Written to")) == (130, 1)
    assert "Interrupted. Work that was finished before is stored." in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.npz", "run.toml"]
    assert len(flockenv.Recording.load(out)) == 61


@pytest.mark.parametrize(
    ("package", "extra", "arguments"),
    [
        *((each, "plot", ["compare"]) for each in ("pandas", "matplotlib", "scipy")),
    ],
)
def test_a_missing_extra_is_named_before_any_work(cli, package, extra, arguments, tmp_path):
    forbid = f"import sys; sys.modules[{package!r}] = None"
    done = cli.process(*arguments, "--out", tmp_path / "a", before=forbid)
    assert done.returncode == 2
    assert f"{package} is not installed: pip install 'flockenv[{extra}]'" in done.stderr
    assert not (tmp_path / "a").exists()


def everything(terminal: int) -> str:
    """What is printed on a terminal until its program ends."""
    reported = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:  # Linux's way to say that the other end is closed.
            part = b""
        if not part:
            return reported.decode(errors="replace")
        reported += part
