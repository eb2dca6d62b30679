"""Law: files are read without trust and written whole."""

import math
import os
import re
import signal
import socket
import subprocess
import sys
from decimal import Decimal

import numpy as np
import pandas as pd
import pytest

from flockenv import (
    Flock,
    FlockError,
    FlockParameters,
    LeadersEnv,
    ParameterError,
    Recording,
    simulate,
)
from flockenv._io.arguments import series
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv._io.atomic_write import atomic_write, remove_leftovers, write_text
from flockenv._io.toml import read_toml_file
from flockenv.cli import app
from flockenv.policies import load
from flockenv.runs.sweep import read_sweep

KILLED = """
import os, signal, sys
from flockenv._io.atomic_write import atomic_write
with atomic_write(sys.argv[1]) as file:
    file.write(b"half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_writer_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], timeout=60)
    assert done.returncode == -signal.SIGKILL
    assert path.read_text() == "old"
    write_text(path, "new")
    assert path.read_text() == "new"


def test_two_writers_of_a_file_do_not_meet(tmp_path):
    path = tmp_path / "[a]*.txt"
    with atomic_write(path) as file:
        file.write(b"first")
        write_text(path, "second")
        assert path.read_bytes() == b"second"
    assert path.read_bytes() == b"first"
    assert list(tmp_path.iterdir()) == [path]


def test_names_may_be_as_long_as_the_file_system_takes(tmp_path):
    for name in ("x" * 251 + ".txt", "ü" * 125 + ".txt"):
        write_text(tmp_path / name, "whole")
        assert (tmp_path / name).read_text() == "whole"


READERS = {
    "policies.load json": (".json", load),
    "policies.load npz": (".npz", load),
    "policies.load zip": (".zip", lambda path: load(path, trust=True)),
    "simulate": (
        ".json",
        lambda path: simulate(FlockParameters(n_leaders=1), 0, 0.1, policy=str(path)),
    ),
    "Recording.load": (".npz", Recording.load),
    "read_sweep": (".toml", read_sweep),
    "TOML": (".toml", lambda path: read_toml_file(path, str(path))),
    "flockenv run --params": (".toml", lambda path: command("run", "--params", path)),
    "flockenv run --policy": (".json", lambda path: command("run", "--policy", path)),
    "flockenv compare --policy": (".npz", lambda path: command("compare", "--policy", path)),
    "flockenv sweep": (".toml", lambda path: command("sweep", path)),
    "flockenv replay": (".npz", lambda path: command("replay", path)),
}
UNUSUAL = ("pipe", "socket", "device", "folder", "link to a pipe", "link to nothing", "nothing")


def command(*words):
    """Run a command in this process, with the errors that it ends with."""
    app([str(word) for word in words], standalone_mode=False)


def unusual(kind, path):
    """Put something else than a file at a path."""
    if kind == "socket":
        listening = socket.socket(socket.AF_UNIX)
        listening.bind(str(path))
        listening.close()
    elif kind == "folder":
        path.mkdir()
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind.startswith("link"):
        path.symlink_to(path.with_name("target"))
        if kind == "link to a pipe":
            os.mkfifo(path.with_name("target"))
    elif kind == "pipe":
        os.mkfifo(path)
    return path


@pytest.mark.timeout(20)
@pytest.mark.parametrize("kind", UNUSUAL)
@pytest.mark.parametrize(("suffix", "read"), READERS.values(), ids=READERS.keys())
def test_what_is_no_file_is_named_and_not_waited_for(suffix, read, kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = unusual(kind, tmp_path / f"x{suffix}")
    with pytest.raises((FlockError, OSError)) as raised:
        read(path)
    words = f"{raised.value} {getattr(raised.value, 'filename', '')}"
    assert path.name in words
    if kind in ("pipe", "socket", "device", "link to a pipe"):
        assert isinstance(raised.value, ParameterError)
        assert "not a file but a device, a pipe or a socket" in words


@pytest.mark.parametrize("kind", ["pipe", "socket", "device", "link to a pipe", "folder"])
@pytest.mark.parametrize("force", [False, True])
def test_nothing_takes_the_place_of_what_is_no_file(kind, force, tmp_path):
    path = unusual(kind, tmp_path / "run.npz")

    def state():
        # All but the time of the last access, which following a link may change.
        each = path.lstat()
        kept = (each.st_mode, each.st_dev, each.st_ino, each.st_nlink, each.st_size)
        return *kept, each.st_mtime_ns

    before = state()
    options = ["--minutes", "0.01", "--out", path, *(["--force"] if force else [])]
    for write in (
        lambda: command("run", *options),
        lambda: write_text(path, "new"),
        lambda: simulate(FlockParameters(), 0, 0.1).save(path),
    ):
        with pytest.raises((ParameterError, OSError), match=r"run\.npz"):
            write()
    assert state() == before
    assert not [each for each in tmp_path.iterdir() if each.name.endswith(".tmp")]


def test_what_a_killed_process_left_is_removed_unless_it_is_held(tmp_path):
    within = tmp_path / "runs" / "ab"
    within.mkdir(parents=True)
    for folder in (tmp_path, within):
        subprocess.run([sys.executable, "-c", KILLED, str(folder / "a.txt")], timeout=60)
    own = tmp_path / ".mine.tmp"
    own.write_text("kept")

    def left():
        return sorted(path.parent.name for path in tmp_path.rglob(".*.tmp") if path != own)

    assert len(left()) == 2
    with atomic_write(within / "held.txt") as file:
        file.write(b"half")
        remove_leftovers(tmp_path)
        assert left() == ["ab", "ab"]
        remove_leftovers(tmp_path, recursive=True)
        assert left() == ["ab"]
    assert left() == []
    assert (within / "held.txt").read_bytes() == b"half"
    assert own.read_text() == "kept"


def test_json_with_a_byte_order_mark_is_read(tmp_path):
    text = load("learned", pool="wide").to_json()
    for mark in (b"", b"\xef\xbb\xbf"):
        (tmp_path / "wide.json").write_bytes(mark + text.encode())
        assert load(tmp_path / "wide.json").digest == load("learned", pool="wide").digest


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: FlockParameters(bw_s=-1e300), "bw_s = -1e300"),
        (lambda: FlockParameters(c4=1e300), "c4 = 1e300"),
        (lambda: FlockParameters(dt_s=1e-300), "dt_s = 1e-300"),
        (lambda: FlockParameters(pool=(1e300, 1e299)), "(1e300, 1e299)"),
        (lambda: simulate(FlockParameters(), 0, 1e300), "duration_s = 1e300"),
        (lambda: simulate(FlockParameters(), 0, 1.0, 1e300), "sample_hz = 1e300"),
        (lambda: simulate(FlockParameters(), 0, 1.0, control_hz=1e300, policy="damped law"), ""),
        (lambda: LeadersEnv(episode_s=1e300), "episode_s = 1e300"),
        (lambda: LeadersEnv(reward={"jam": 1e300}), "1e300"),
        (lambda: LeadersEnv(bw_s=(1e299, 1e300)), "(1e299, 1e300)"),
        (lambda: LeadersEnv(decision_period_s=1e300), "1e300"),
        (lambda: Flock(FlockParameters(n_boats=1), 1).advance(1e300), "1e300"),
        (lambda: placed([[1e300, 0, 0]]), "[1e300, 0"),
        (lambda: placed([[-1e12, 2e-300, 0.1]]), "-1000000000000, 2e-300, 0.1]"),
        (lambda: FlockParameters(n_boats=10**400), "n_boats = 1000"),
        (lambda: FlockParameters(n_boats=10**5000), "n_boats = a value that cannot be printed"),
        (lambda: load("learned", pool=10**5000), "pool = a value that cannot be printed"),
        (lambda: LeadersEnv(render_mode=10**5000), "render_mode = a value that cannot be printed"),
        (lambda: FlockParameters(bw_s=0.1 + 0.2, dt_s=-1 / 3), "dt_s = -0.3333333333333333 "),
    ],
)
def test_numbers_in_messages_are_short(call, words):
    with pytest.raises(ParameterError) as raised:
        call()
    assert words in str(raised.value)
    # Of integers the first digits are shown.
    assert re.search(r"\d{22}", str(raised.value)) is None or words == "n_boats = 1000"


def placed(pose):
    flock = Flock(FlockParameters(n_boats=1, pool=(math.inf, 0.0)), 1)
    flock.set_state(pose, [[0, 0, 0]])


@pytest.mark.parametrize(
    "values",
    [["1", None], [np.datetime64("2020"), None], [10**400, None], pd.DataFrame(np.ones((3, 2)))],
)
def test_what_is_no_series_of_numbers_is_refused(values):
    with pytest.raises(ParameterError, match="x is not accepted"):
        series(values, "x")


def test_gaps_in_numbers_are_nan():
    given = [1, None, np.float32(2.5), Decimal("0.5")]
    np.testing.assert_array_equal(series(given, "x"), [1.0, np.nan, 2.5, 0.5])


def test_what_is_written_is_never_too_small_to_be_read(tmp_path):
    """The headers of arrays count among the 64 MiB that a small file may hold."""
    write_arrays(tmp_path / "a.npz", {"a": np.zeros((64 << 20) - 8, np.uint8)}, compressed=True)
    assert read_arrays(tmp_path / "a.npz")["a"].shape == ((64 << 20) - 8,)


def test_toml_with_a_byte_order_mark_is_read(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfn_boats = 7\n")
    assert read_toml_file(tmp_path / "a.toml", "it") == {"n_boats": 7}
    assert FlockParameters.from_toml("\ufeffn_boats = 7").n_boats == 7
    for data, words in [(b"\xff\xfe", "is not TOML"), (b"\0", "is not TOML")]:
        (tmp_path / "a.toml").write_bytes(data)
        with pytest.raises(ParameterError, match=words):
            read_toml_file(tmp_path / "a.toml", "it")
    with pytest.raises(ParameterError, match="cannot be read: No such file"):
        read_toml_file(tmp_path / "none.toml", "it")
