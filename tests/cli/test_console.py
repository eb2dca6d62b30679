"""Law: what is printed is printed on every console, and Ctrl-C ends a command in a line."""

import json
import os

import pytest

from flockenv.cli.console import print_json


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_consoles_without_greek_letters(cli, encoding, tmp_path):
    words = ["run", "--minutes", "0.2", "--set", "n_boats=4", "--out", tmp_path / "a.npz"]
    done = cli.process(*words, PYTHONIOENCODING=encoding, PYTHONUTF8="0")
    assert done.returncode == 0, done.stderr
    assert ("mean Ψ_o" if encoding == "utf-8" else "mean ?_o") in done.stdout


def test_json_is_ascii(capsys):
    print_json(data := {"Ψ": [os.fsdecode(b"\xff.npz"), None]})
    reported = capsys.readouterr().out
    assert reported.isascii()
    assert json.loads(reported) == data
