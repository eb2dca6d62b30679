"""Law: a field has one name in every command, and a wrong one is answered with the line to type."""

import shlex

import pytest
import typer

from flockenv.cli import app

COMMANDS = typer.main.get_command(app).commands


def test_fields_are_options_of_every_command_that_makes_flocks():
    for name in ("run", "compare", "train"):
        options = {each for parameter in COMMANDS[name].params for each in parameter.opts}
        assert {"--pool", "--n-boats", "--n-leaders", "--bw-s", "--set"} <= options


@pytest.mark.parametrize(
    ("given", "typed"),
    [
        ("run --n-boat 10", "run --n-boats 10"),
        ("run --n_boats=10 --seed 3", "run --n-boats 10 --seed 3"),
        ("run --pool narrow --dt-s 0.01 --seed 3", "run --pool narrow --set dt_s=0.01 --seed 3"),
        ("run --quiet --bw 0.4", "run --quiet --bw-s 0.4"),
        ("run --leaders_reverse", "run --set leaders_reverse=VALUE"),
        ("compare --scheme moreau", "compare --set scheme=moreau"),
        ("compare --action-mode heading", "compare --env action_mode=heading"),
        ("train --reward-horizon-s 3", "train --set reward_horizon_s=3"),
        ("replay --sped 3 a.npz", "replay --speed 3 a.npz"),
        ("replay --bw-s 0.3 a.npz", "run --set bw_s=0.3"),
    ],
)
def test_the_answer_is_the_line_to_type(cli, given, typed):
    done = cli(*shlex.split(given))
    assert done.returncode == 2
    assert f"`flockenv {typed}`" in done.stderr


def test_what_is_like_nothing_is_no_guess(cli):
    assert "see --help" in cli("presets", "--nothing-like-it").stderr
    # What follows an option is its value, whatever it looks like.
    done = cli("replay", "--name", "--dt-s", "none.npz")
    assert "has no option" not in done.stderr


def test_a_field_that_is_given_twice_is_refused(cli, tmp_path):
    out = ["--out", tmp_path / "a.npz"]
    for named in (["--n-boats", "3"], ["--pool", "narrow"], ["--bw-s", "0.2"]):
        name = named[0][2:].replace("-", "_")
        done = cli("run", *named, "--set", f"{name}={named[1]}", *out)
        assert f"{named[0]} and --set {name} are both given" in done.stderr
    pytest.importorskip("stable_baselines3")
    done = cli("train", "--n-boats", 9, "--set", "n_boats=9")
    assert "--n-boats and --set n_boats" in done.stderr


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("run --bw-s 0,3", "--bw-s 0,3 is not accepted: type `--bw-s 0.3`"),
        ("run --minutes=0,5 -q", "--minutes 0,5 is not accepted: type `--minutes 0.5`"),
        ("compare --pool 180,97", "--pool 180,97 is not accepted: type `--pool '(180,97)'`"),
        ("run --pool 180,97", "--pool 180,97 is not accepted: type `--pool '(180,97)'`"),
        ("run --minutes 0", "--minutes 0 is not accepted: more than 0, as in --minutes 0.1"),
    ],
)
def test_a_number_in_another_form_is_answered_with_what_to_type(cli, tmp_path, line, answer):
    done = cli(*shlex.split(line), "--out", tmp_path / "a.npz")
    assert (done.returncode, done.stderr.strip()) == (2, f"Error: {answer}")
    assert not any(tmp_path.iterdir())


def test_an_integer_with_a_comma_is_no_decimal(cli):
    assert "`--n-boats 3.5`" not in cli("run", "--n-boats", "3,5").stderr


@pytest.mark.parametrize(
    ("line", "twice"),
    [
        ("run --bw-s 0.2 --bw-s=0.3", "--bw-s"),
        ("run --contacts --no-contacts", "--contacts"),
        ("analyze a.npz --json --out a.csv --out b.csv", "--out"),
        ("compare --episodes 2 --policy learned --policy mine.npz --episodes 4", "--episodes"),
        ("sweep a.toml --workers 1 --dry-run --workers 2", "--workers"),
        ("train --seed 1 --seed 1", "--seed"),
    ],
)
def test_an_option_of_one_value_that_is_given_twice_is_refused(cli, line, twice):
    done = cli(*shlex.split(line))
    assert (done.returncode, done.stderr.strip()) == (
        2,
        f"Error: {twice} is given twice: give it once",
    )


def test_flags_and_lists_may_come_twice(cli, tmp_path):
    out = ["--n-boats", 3, "--minutes", "0.02", "--out", tmp_path / "a.npz"]
    cli.succeeds("run", "-q", "--quiet", "--set", "c4=0.1", "--set", "c3=0.2", *out)


def test_a_run_has_the_fields_that_are_named(cli, tmp_path):
    fields = ["--n-boats", "6", "--n-leaders", "2", "--pool", "(80, 30)", "--bw-s", "0.2"]
    out = tmp_path / "a.npz"
    cli.succeeds("run", *fields, "--minutes", "0.02", "--out", out)
    text = out.with_suffix(".toml").read_text()
    assert all(line in text for line in ("n_boats = 6", "n_leaders = 2", "bw_s = 0.2"))
    assert "80.0" in text
