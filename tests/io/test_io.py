"""Law: files are read without trust and written whole."""

import os
import signal
import subprocess
import sys

import pytest

from flockenv import FlockError, FlockParameters, ParameterError, Recording
from flockenv._io.atomic_write import atomic_write, write_text
from flockenv._io.toml import read_toml_file
from flockenv.policies import load

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


@pytest.mark.parametrize("read", [load, Recording.load])
def test_devices_and_pipes_are_no_npz_files(read, tmp_path):
    os.mkfifo(tmp_path / "pipe.npz")
    for path in ("/dev/zero", "/dev/null", tmp_path / "pipe.npz"):
        with pytest.raises(FlockError, match="is no "):
            read(path)


def test_a_device_is_no_toml():
    with pytest.raises(ParameterError, match="/dev/zero is no file but a device"):
        read_toml_file("/dev/zero", "/dev/zero")


def test_toml_with_a_byte_order_mark_is_read(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfn_boats = 7\n")
    assert read_toml_file(tmp_path / "a.toml", "it") == {"n_boats": 7}
    assert FlockParameters.from_toml("\ufeffn_boats = 7").n_boats == 7
    for data, words in [(b"\xff\xfe", "is no TOML"), (b"\0", "is no TOML")]:
        (tmp_path / "a.toml").write_bytes(data)
        with pytest.raises(ParameterError, match=words):
            read_toml_file(tmp_path / "a.toml", "it")
    with pytest.raises(ParameterError, match="cannot be read: No such file"):
        read_toml_file(tmp_path / "none.toml", "it")
