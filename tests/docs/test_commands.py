"""Law: a command that a file of data or a script names is one that its program takes."""

import argparse
import ast
import json
import re
import runpy
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from flockenv.cli import app

pytest.importorskip("stable_baselines3")

REPOSITORY = Path(__file__).parents[2]
DATA = ("baselines", "docs", "examples", "flockenv", "src", "studies")
SCRIPTS = ("baselines", "docs", "examples", "studies")
PROGRAMS = r"python (?:(?:baselines|examples)/\w+\.py|-m studies\.[\w.]+)|flockenv \w+"
LINE = re.compile(rf"^#? *((?:{PROGRAMS})[^|;<>]*)$")


class Parsed(Exception):
    """The program has read its command line."""


def records(value: Any) -> Iterator[tuple[str, str]]:
    """Each command in data, with the commit that stands beside it, if one does."""
    if isinstance(value, dict):
        for name, text in value.items():
            if name.endswith("command"):
                yield text, value.get(f"{name.removesuffix('command')}commit", "")
    for each in value.values() if isinstance(value, dict) else value:
        if isinstance(each, dict | list):
            yield from records(each)


def recorded() -> Iterator[tuple[str, str, str]]:
    """File, command and commit of each command in data, docstrings of scripts and comments."""
    for folder in DATA:
        for path in sorted((REPOSITORY / folder).rglob("*")):
            name = str(path.relative_to(REPOSITORY))
            if {"_build", "__pycache__"} & {*path.parts}:
                continue
            if path.suffix == ".json":
                yield from ((name, *each) for each in records(json.loads(path.read_text("utf-8"))))
            elif path.suffix == ".toml":
                text = path.read_text("utf-8")
                yield from ((name, *each) for each in records(tomllib.loads(text)))
                yield from ((name, line, "") for line in lines_of(text))
            elif path.suffix == ".py" and folder in SCRIPTS:
                text = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
                yield from ((name, line, "") for line in lines_of(text))


def lines_of(text: str) -> Iterator[str]:
    for line in text.replace("\\\n", " ").splitlines():
        if found := LINE.match(line.split("   #")[0]):
            yield found[1]


def refusal(command: str, monkeypatch: pytest.MonkeyPatch) -> str | None:
    """Say why a program does not take a command line; nothing is run."""
    # What a shell puts in for a variable, and what a reader does for a name in capitals.
    command = re.sub(r"\$\w+|(?<= )(?:SEED|FLOCK_HOURS)\b", "7", command)
    program, script, *words = shlex.split(command, comments=True)
    if program == "flockenv":
        commands = typer.main.get_command(app).commands
        try:
            commands[script].make_context(script, words)
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return None
    if script == "-m":
        module, *words = words
        script = f"{module.replace('.', '/')}.py"
    path = REPOSITORY / script
    if not path.exists():
        return f"there is no {script}"
    text = path.read_text("utf-8")
    if "argparse" not in text:
        taken = [int(place) for place in re.findall(r"sys\.argv\[(\d+)\]", text)]
        return f"{len(words)} arguments" if taken and len(words) != max(taken) else None

    def parse_args(parser: argparse.ArgumentParser, arguments: Any = None, _: Any = None) -> None:
        parser.parse_known_args(arguments)[1] and parser.error("unknown arguments")
        raise Parsed

    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", parse_args)
    monkeypatch.setattr(sys, "argv", [script, *words])
    monkeypatch.syspath_prepend(str(path.parent))
    monkeypatch.syspath_prepend(str(REPOSITORY))
    try:
        runpy.run_path(str(path), run_name="__main__")
    except Parsed:
        return None
    except ImportError as error:
        if (path.parent / f"{error.name}.py").exists() or "flockenv" in str(error.name):
            raise  # One of ours that is gone.
        pytest.skip(f"an optional package: {error}")
    except SystemExit as error:
        return f"exit code {error.code}"
    return "its command line is not read"


def was_there(script: str, commit: str) -> bool:
    """Whether a script was in the tree of a commit; True in a copy without that history."""

    def git(*words: str) -> int:
        return subprocess.run(["git", "-C", REPOSITORY, *words], capture_output=True).returncode

    commit = commit.removesuffix("+")
    is_known = git("cat-file", "-e", f"{commit}^{{commit}}") == 0
    return not is_known or git("cat-file", "-e", f"{commit}:{script}") == 0


EVERY = [*recorded()]


def test_commands_are_found():
    files = {file for file, _, _ in EVERY}
    assert files >= {
        "studies/tuned_laws/tune_laws.py",
        "docs/sweep-example.toml",
        "studies/tuned_laws/results/gains.toml",
        "src/policies/learned/wide.json",
    }


@pytest.mark.parametrize(("file", "command", "commit"), EVERY)
def test_commands_are_taken(file, command, commit, monkeypatch, capsys):
    """Now, or in the sources of the commit that stands beside them: policies are kept for long."""
    monkeypatch.chdir(REPOSITORY)
    why = refusal(command, monkeypatch)
    if why and commit:
        assert re.fullmatch(r"[0-9a-f]{12}\+?", commit)
        assert was_there(shlex.split(command)[1], commit)
        return
    assert why is None, f"{file}: {command}: {why}: {capsys.readouterr().err}"


@pytest.mark.parametrize(
    "command",
    [
        "flockenv run --leaders 3",
        "flockenv judge",
        "python baselines/average_policies.py a.npz",
        "python baselines/evolution_strategy.py --form leaning",
        "python -m studies.planning.plan_ahead --noise none",
    ],
)
def test_what_no_program_takes_is_found(command, monkeypatch):
    monkeypatch.chdir(REPOSITORY)
    assert refusal(command, monkeypatch)
