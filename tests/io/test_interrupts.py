"""Law: Ctrl-C ends a command where nothing is half done, a second one at once; no file is left."""

import contextlib
import itertools
import signal
import subprocess
import sys
from functools import partial
from types import FrameType
from typing import Any

import pytest

from flockenv._io import atomic_write
from flockenv._io.atomic_write import write_text
from flockenv._io.interrupts import end_if_interrupted, interrupted, noted_interrupts

press = partial(signal.raise_signal, signal.SIGINT)


@pytest.fixture(autouse=True)
def _hangs_up():
    """Under nohup the end of a terminal is ignored, also by what tests start."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_noted_until_work_can_end(number, capfd):
    before = signal.getsignal(number)
    with noted_interrupts():
        end_if_interrupted()
        assert not interrupted()
        signal.raise_signal(number)
        assert interrupted()
        with pytest.raises(KeyboardInterrupt):
            end_if_interrupted()
    assert not interrupted()
    assert signal.getsignal(number) is before
    assert "Ctrl-C again does not wait" in capfd.readouterr().err


def test_a_block_within_another_changes_nothing():
    with noted_interrupts():
        with noted_interrupts():
            press()
        assert interrupted()


def test_ignored_interrupts_stay_ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with noted_interrupts():
            press()
            assert not interrupted()
    finally:
        signal.signal(signal.SIGINT, before)


TWICE = """
import signal, sys
from flockenv._io.atomic_write import atomic_write
from flockenv._io.interrupts import noted_interrupts
with noted_interrupts(), atomic_write(sys.argv[1]) as file:
    file.write(b"half")
    signal.raise_signal(signal.SIGINT)
    print("goes on", flush=True)
    signal.raise_signal(signal.SIGINT)
    print("is not reached", flush=True)
"""


def test_a_second_one_ends_the_process_and_its_temporary_file(tmp_path):
    words = [sys.executable, "-c", TWICE, str(tmp_path / "a.txt")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (130, "goes on\n")
    assert list(tmp_path.iterdir()) == []


HANGUP = """
import signal, sys
from flockenv._io.interrupts import interrupted, noted_interrupts
with noted_interrupts():
    for number in sys.argv[1:]:
        signal.raise_signal(int(number))
    print(interrupted(), flush=True)
"""


@pytest.mark.parametrize(
    ("numbers", "code", "printed"),
    [
        ((signal.SIGHUP,), 0, "True\n"),
        # The system and the shell both tell of a terminal's end, and systemd after SIGTERM.
        ((signal.SIGHUP, signal.SIGHUP), 0, "True\n"),
        ((signal.SIGTERM, signal.SIGHUP), 0, "True\n"),
        ((signal.SIGHUP, signal.SIGTERM), 130, ""),
        ((signal.SIGTERM, signal.SIGINT), 130, ""),
    ],
)
def test_the_end_of_a_terminal_never_ends_work_at_once(numbers, code, printed):
    words = [sys.executable, "-c", HANGUP, *(str(int(each)) for each in numbers)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (code, printed)


def test_nohup_is_kept():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with noted_interrupts():
            signal.raise_signal(signal.SIGHUP)
            assert not interrupted()
    finally:
        signal.signal(signal.SIGHUP, before)


class Interrupt:
    """Ctrl-C before the n-th step of the writing of a file."""

    FILES = (atomic_write.__file__, contextlib.__file__)

    def __init__(self, step: int) -> None:
        self.left = step

    def __call__(self, frame: FrameType, event: str, argument: Any) -> Any:
        if frame.f_code.co_filename not in self.FILES:
            return None
        frame.f_trace_opcodes = True
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt
        return self


# A file that was just opened is closed where nothing holds it any more, which Python warns of.
@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("old", [None, "old"])
def test_wherever_writing_is_interrupted_no_file_is_left(old, tmp_path):
    path, found = tmp_path / "file", set()
    for step in itertools.count(1):
        path.unlink(missing_ok=True)
        if old is not None:
            path.write_text(old)
        pressed = Interrupt(step)
        sys.settrace(pressed)
        try:
            write_text(path, "new")
        except KeyboardInterrupt:
            pass
        finally:
            sys.settrace(None)
        # As Python does when it ends.
        atomic_write.remove_temporary_files()
        assert {each.name for each in tmp_path.iterdir()} <= {path.name}
        found.add(path.read_text() if path.exists() else None)
        if pressed.left > 0:
            break
    assert found == {old, "new"}
    assert step > 100
