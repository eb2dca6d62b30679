"""Ctrl-C waits for the end of what must not stop halfway, and is never lost."""

import signal

import pytest

from flockenv._io.interrupts import held_interrupts


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
