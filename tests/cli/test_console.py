"""Law: what is printed is printed on every console, in the signs that it has."""

import io
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import typer

import flockenv
from flockenv.cli.console import (
    ends_on_interrupt,
    finished_in,
    interruptible,
    print_anywhere,
    print_json,
    progress_bar,
    say,
)


@pytest.fixture
def printed(monkeypatch):
    """Return what is printed to a console of an encoding, as its bytes."""

    def printed_on(encoding, *texts, print_one=say) -> bytes:
        raw = io.BytesIO()
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding, write_through=True))
        print_anywhere()
        for text in texts:
            print_one(text)
        return raw.getvalue()

    return printed_on


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "latin-1", "cp437", "utf-8"])
def test_greek_is_printed_or_spelt(encoding, printed):
    text = "mean Ψ_o ≥ 0.3 → φ ≤ π – 3×2… ♥"
    reported = printed(encoding, text).decode(encoding)
    if encoding == "utf-8":
        assert reported == f"{text}\n"
    elif encoding == "ascii":
        assert reported == "mean Psi_o >= 0.3 -> phi <= pi - 3x2... ?\n"
    else:
        assert reported.startswith("mean Psi_o ")
        assert reported.count("?") == 1


def test_every_sign_of_the_package_has_a_plain_one(printed):
    package = Path(flockenv.__file__).parent
    sources = "".join(path.read_text("utf-8") for path in package.rglob("*.py"))
    signs = "".join(sorted({sign for sign in sources if not sign.isascii()}))
    assert "Ψ" in signs
    assert b"?" not in printed("ascii", signs)


def test_a_file_name_comes_out_as_its_own_bytes(printed):
    name = os.fsdecode(b"\xff\xfe.npz")
    for encoding in ("utf-8", "ascii", "latin-1"):
        assert printed(encoding, name) == b"\xff\xfe.npz\n"


def test_json_is_the_same_on_every_console(printed):
    data = {"Ψ": [os.fsdecode(b"\xff.npz"), None]}
    for encoding in ("utf-8", "ascii", "cp1252"):
        reported = printed(encoding, data, print_one=print_json)
        assert reported.isascii()
        assert json.loads(reported) == data


def test_a_bar_ends_full_but_after_an_error(capsys):
    with progress_bar(False) as bar:
        bar.add_task("parts", total=1.0, completed=0.999)
    assert bar.finished
    assert "100 %" in capsys.readouterr().err
    bar.reset(0)
    with pytest.raises(InterruptedError), bar:
        raise InterruptedError
    assert not bar.finished
    assert capsys.readouterr().err == "", "no empty line above the error"


# Ctrl-C as soon as a package is looked for.
PRESSED = """
import signal, sys
class Finder:
    def find_spec(name, path, target=None):
        if name == {name!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder)
"""


@pytest.mark.parametrize("name", ["flockenv", "numpy", "flockenv.cli.train"])
def test_an_interrupt_while_packages_are_imported_ends_in_a_line(name):
    source = f"{PRESSED.format(name=name)}\nfrom flockenv_command import main\nmain()"
    done = subprocess.run(
        [sys.executable, "-c", source, "presets"], capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "Interrupted.\n"


def test_an_interrupt_while_arguments_are_read_ends_in_a_line():
    source = (
        "import signal, typer\n"
        "typer.core.TyperCommand.make_parser = lambda *_: signal.raise_signal(signal.SIGINT)\n"
        "from flockenv_command import main\nmain()"
    )
    done = subprocess.run(
        [sys.executable, "-c", source, "run"], capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "Interrupted.\n"


def test_an_interrupt_that_is_ignored_stays_so_while_packages_are_imported():
    ignored = "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"
    source = f"{ignored}{PRESSED.format(name='numpy')}\nfrom flockenv_command import main\nmain()"
    done = subprocess.run(
        [sys.executable, "-c", source, "--version"], capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_what_is_finished_is_said_and_the_innermost_word_counts(capsys):
    @ends_on_interrupt
    def command(parts):
        with interruptible("outside"), finished_in(Path("here"), parts):
            signal.raise_signal(signal.SIGINT)
            with progress_bar(True) as bar:
                bar.advance(bar.add_task("a unit of work"))

    for parts, said in ([], "Nothing was written."), (["a"], "Finished and stored in here: a."):
        with pytest.raises(typer.Exit) as ended:
            command(parts)
        assert ended.value.exit_code == 130
        assert f"Interrupted. {said}" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
