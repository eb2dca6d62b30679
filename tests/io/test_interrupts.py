"""Ctrl-C waits for the end of what must not stop halfway, and is never lost."""

import signal
import sys
import time
from threading import Event

import pytest

from flockenv._io.interrupts import held_interrupts, interrupts_wait_for_imports, on_interrupt


def press() -> None:
    signal.raise_signal(signal.SIGINT)


def test_an_interrupt_is_raised_at_the_end_of_the_block() -> None:
    reached = []

    def held() -> None:
        with held_interrupts():
            press()
            reached.append("the end")

    with pytest.raises(KeyboardInterrupt):
        held()
    assert reached == ["the end"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_block_can_be_left_sooner() -> None:
    reached = []

    def left() -> None:
        with held_interrupts() as release:
            release()
            reached.append("before")
            press()
            release()
            reached.append("after")

    with pytest.raises(KeyboardInterrupt):
        left()
    assert reached == ["before"]


def test_a_second_interrupt_is_not_held_back() -> None:
    reached = []

    def pressed_twice() -> None:
        with held_interrupts():
            press()
            reached.append("once")
            press()
            reached.append("twice")

    with pytest.raises(KeyboardInterrupt):
        pressed_twice()
    assert reached == ["once"]


def test_an_error_is_reported_before_a_held_interrupt() -> None:
    def failing() -> None:
        with held_interrupts():
            press()
            raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        failing()


def test_ignored_interrupts_stay_ignored() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with held_interrupts() as release:
            press()
            release()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


PRESSED_AMID_IMPORT = """
import signal

signal.raise_signal(signal.SIGINT)
signal.raise_signal(signal.SIGINT)
done = True
"""


def soon(over: object) -> None:
    """Wait, not in one go: a handler runs between two bytecodes."""
    end = time.monotonic() + 20.0
    while not over and time.monotonic() < end:
        time.sleep(0.01)


def test_an_interrupt_waits_for_the_end_of_an_import(tmp_path, monkeypatch) -> None:
    (tmp_path / "pressed_amid_import.py").write_text(PRESSED_AMID_IMPORT)
    monkeypatch.syspath_prepend(tmp_path)

    def importing() -> None:
        with interrupts_wait_for_imports():
            import pressed_amid_import

            assert pressed_amid_import.done
            soon([])

    with pytest.raises(KeyboardInterrupt):
        importing()
    assert sys.modules.pop("pressed_amid_import").done
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_action_of_ones_own_waits_for_the_end_of_an_import(tmp_path, monkeypatch) -> None:
    (tmp_path / "pressed_amid_import.py").write_text(PRESSED_AMID_IMPORT)
    monkeypatch.syspath_prepend(tmp_path)
    acted: list[bool] = []
    with (
        interrupts_wait_for_imports(),
        on_interrupt(lambda *_: acted.append("pressed_amid_import" in finished)),
    ):
        finished: list[str] = []
        import pressed_amid_import

        finished.append(pressed_amid_import.__name__)
        soon(acted)
    del sys.modules["pressed_amid_import"]
    assert acted == [True]


def test_an_interrupt_wakes_a_thread_that_waits_for_a_lock(tmp_path, monkeypatch) -> None:
    (tmp_path / "pressed_amid_import.py").write_text(PRESSED_AMID_IMPORT)
    monkeypatch.syspath_prepend(tmp_path)

    def waiting() -> None:
        with interrupts_wait_for_imports():
            import pressed_amid_import  # noqa: F401

            Event().wait(20.0)
            raise AssertionError("the interrupt was not raised while the thread waited")

    with pytest.raises(KeyboardInterrupt):
        waiting()
    del sys.modules["pressed_amid_import"]
