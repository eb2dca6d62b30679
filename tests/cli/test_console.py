"""Law: what is printed is printed on every console, and Ctrl-C ends a command in a line."""

import json
import os
import signal

import pytest
import typer

from flockenv.cli.console import ends_on_interrupt, print_json, progress


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_consoles_without_greek_letters(cli, encoding, tmp_path):
    words = ["run", "--minutes", "0.2", "--set", "n_boats=4", "--out", tmp_path / "a.npz"]
    done = cli.process(*words, PYTHONIOENCODING=encoding, PYTHONUTF8="0")
    assert done.returncode == 0, done.stderr
    assert ("mean Ψ_o" if encoding == "utf-8" else "mean ?_o") in done.stdout


def test_json_is_ascii(capsys):
    data = {"Ψ": [os.fsdecode(b"\xff.npz"), None]}
    print_json(data)
    reported = capsys.readouterr().out
    assert reported.isascii()
    assert json.loads(reported) == data


def test_ctrl_c_ends_work_where_it_moves_on(capsys):
    units = []

    @ends_on_interrupt
    def command():
        with progress("at work", 3.0, quiet=False) as advance:
            for unit in range(3):
                signal.raise_signal(signal.SIGINT)
                units.append(unit)
                advance()

    with pytest.raises(typer.Exit) as ended:
        command()
    assert (ended.value.exit_code, units) == (130, [0])
    assert "Interrupted. What was finished before is stored." in capsys.readouterr().err
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
