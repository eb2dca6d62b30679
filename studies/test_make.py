"""Law: make runs the studies that are named, waits for them, and lists what it does not run."""

import contextlib
import signal
from typing import ClassVar

import pytest

from studies import make, study


def test_an_unknown_study() -> None:
    with pytest.raises(SystemExit, match="'fig99' is not a study of this folder: "):
        make.main(["fig99"])


class _Process(contextlib.AbstractContextManager):
    """A script that ends at once, or at the second wait if the first is interrupted."""

    made: ClassVar[list[str]] = []
    waits: ClassVar[list[BaseException | signal.Signals | None]] = []
    terminated: ClassVar[int] = 0

    def __init__(self, command: list[str], **_: object) -> None:
        self.made.append(command[2].removeprefix("studies.").replace(".", "/"))

    def __exit__(self, *_: object) -> None:
        pass

    def wait(self) -> int:
        if self.waits and (happens := self.waits.pop(0)):
            if isinstance(happens, signal.Signals):
                signal.raise_signal(happens)
            else:
                raise happens
        return 0

    def terminate(self) -> None:
        type(self).terminated += 1


def test_what_make_does_not_run_is_listed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(make.subprocess, "Popen", _Process)
    monkeypatch.setattr(_Process, "made", made := [])
    make.main([])
    listed = capsys.readouterr().out.partition("not here: ")[2].strip().split(", ")
    assert made == make.scripts()
    runs = [path for path in study.HERE.glob("*/*.py") if "__main__" in path.read_text("utf-8")]
    assert sorted(made + listed) == sorted(f"{path.parent.name}/{path.stem}" for path in runs)
    make.main(["critical_noise"])
    assert capsys.readouterr().out.endswith("not here: critical_noise/critical_noise\n")


@pytest.mark.usefixtures("_ignored_sigterm")
@pytest.mark.parametrize(("happens", "passed_on"), [(KeyboardInterrupt(), 0), (signal.SIGTERM, 1)])
def test_an_interruption_waits_for_what_a_script_writes(
    monkeypatch: pytest.MonkeyPatch,
    happens: BaseException | signal.Signals,
    passed_on: int,
) -> None:
    monkeypatch.setattr(make.subprocess, "Popen", _Process)
    monkeypatch.setattr(_Process, "terminated", 0)
    monkeypatch.setattr(_Process, "waits", waits := [happens, None])
    with pytest.raises(KeyboardInterrupt):
        make.main(["worth"])
    assert waits == []
    assert _Process.terminated == passed_on
