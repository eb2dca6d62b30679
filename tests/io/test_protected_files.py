"""Law: writing a file respects what somebody set for it: protection, mode, owner and links.

On paper: 444 stays 444 and whole; 600 stays 600; a link stays a link and its file changes.
"""

import os
import stat
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
import pytest

from flockenv import FlockParameters, simulate
from flockenv._io import atomic_write as writing
from flockenv._io.atomic_write import atomic_write, write_csv, write_text
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy
from flockenv.rendering import save_animation
from flockenv.replay import write_replay
from flockenv.tracks import export

SIZE = len(observation_entries())
POLICY = NetworkPolicy([np.full((SIZE, 1), 0.1)], [[0.25]])
RUN = simulate(FlockParameters(n_boats=4, n_leaders=1, pool="narrow"), 1, 0.5)

#: How each kind of file is written, by its ending.
WRITERS = {
    "run.npz": RUN.save,
    "small.npz": lambda path: RUN.save(path, compressed=True),
    "policy.npz": lambda path: POLICY.save(path),
    "page.html": lambda path: write_replay(path, {"run": RUN}),
    "film.gif": lambda path: save_animation(path, [np.zeros((9, 9, 3), np.uint8)], 5.0),
    "boats.csv": lambda path: export(RUN, path, overwrite=True),
    "boats.parquet": lambda path: export(RUN, path, overwrite=True),
    "words.txt": lambda path: write_text(path, "new"),
    "table.csv": lambda path: write_csv(path, pd.DataFrame({"a": [1]})),
}


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("protection", [0o444, 0o400, 0o555])
def test_a_protected_file_stays(name, protection, tmp_path):
    path = tmp_path / name
    path.write_text("somebody's")
    path.chmod(protection)
    with pytest.raises(PermissionError, match="protected against writing"):
        WRITERS[name](path)
    assert (path.read_text(), mode(path)) == ("somebody's", protection)
    assert not list(tmp_path.glob(".*.tmp"))


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("before", [0o600, 0o640, 0o664, 0o755])
def test_a_replaced_file_keeps_its_mode(name, before, tmp_path):
    path = tmp_path / name
    path.write_text("old")
    path.chmod(before)
    WRITERS[name](path)
    assert mode(path) == before
    assert path.read_bytes() != b"old"


def test_a_new_file_has_the_mode_that_the_user_asks_of_all(tmp_path):
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "a.txt", "new")
    finally:
        os.umask(before)
    assert mode(tmp_path / "a.txt") == 0o640


def test_nobody_else_may_read_what_will_be_private_while_it_is_written(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    path.chmod(0o600)
    with atomic_write(path) as file:
        file.write(b"secret")
        file.flush()
        assert mode(Path(file.name)) == 0o600


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives away")
def test_a_replaced_file_keeps_its_owner(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    os.chown(path, 1234, 2345)
    write_text(path, "new")
    assert (path.stat().st_uid, path.stat().st_gid) == (1234, 2345)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_a_link(name, there, tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    path, target = tmp_path / name, disk / name
    path.symlink_to(Path("disk") / name)
    if there:
        target.write_text("old")
    WRITERS[name](path)
    assert path.is_symlink()
    assert path.readlink() == Path("disk") / name
    assert target.read_bytes() != b"old"
    # The temporary file lay beside the target: nothing is left anywhere.
    assert not [each for each in tmp_path.rglob("*") if each.name.endswith(".tmp")]


def test_a_link_into_no_folder_is_named(tmp_path):
    """And not the temporary file, which nobody knows."""
    (tmp_path / "a.txt").symlink_to("missing/a.txt")
    with pytest.raises(FileNotFoundError) as raised:
        write_text(tmp_path / "a.txt", "new")
    assert raised.value.filename == str(tmp_path / "a.txt")


def test_a_link_to_a_protected_file_is_protected(tmp_path):
    (tmp_path / "a.txt").write_text("somebody's")
    (tmp_path / "a.txt").chmod(0o444)
    (tmp_path / "b.txt").symlink_to("a.txt")
    with pytest.raises(PermissionError):
        write_text(tmp_path / "b.txt", "new")
    assert (tmp_path / "a.txt").read_text() == "somebody's"


def test_a_temporary_file_that_cannot_be_removed_keeps_no_other(tmp_path, monkeypatch):
    left = [tmp_path / f".{place:016x}.tmp" for place in range(5)]
    for path in left:
        path.touch()
    left[2].unlink()
    left[2].mkdir()  # A folder cannot be unlinked.
    monkeypatch.setattr(writing, "_temporary", set(left))
    writing.remove_temporary_files()
    assert [path.name for path in tmp_path.iterdir()] == [left[2].name]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["run", "--minutes", "0.01", "--force", "--out", "run.npz"], "run.npz"),
        (["run", "--minutes", "0.01", "--force", "--out", "run.npz"], "run.toml"),
        (["replay", "made.npz", "--html", "page.html"], "page.html"),
        (["analyze", "made.npz", "--out", "a.csv", "--force"], "a.csv"),
        (["analyze", "made.npz", "--out", "a.csv", "--force"], "a.toml"),
        (["analyze", "made.npz", "--plot", "a.png", "--force"], "a.png"),
        (["sweep", "spec.toml", "--out", ".", "--force"], "sweep.toml"),
        (["compare", "--out", "."], "runs.csv"),
        (["demo", "--out", "page.html"], "page.html"),
    ],
)
def test_commands_name_a_protected_file_before_any_work(
    cli, arguments, name, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    RUN.save("made.npz")
    Path("spec.toml").write_text("minutes = 0.1\nseeds = 1\n[[grid]]\nn_boats = [3]\n")
    # Parameters that no run wrote are refused for that alone.
    Path(name).write_text("# flockenv 0.1: seed 1, policy somebody's")
    Path(name).chmod(0o444)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*")}
    done = cli(*arguments)
    assert done.returncode == 2, done.stdout
    assert f"{name} cannot be written: it is protected against writing" in done.stderr
    assert {path: path.read_bytes() for path in tmp_path.rglob("*")} == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs another user")
def test_a_file_of_somebody_else_is_protected():
    """In a folder where anybody may rename files, one that only its owner may write to."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "a.txt")
        Path(folder).chmod(0o777)
        path.write_text("root's")
        path.chmod(0o644)
        child = os.fork()
        if child == 0:
            os.setgid(65534)
            os.setuid(65534)
            try:
                write_text(path, "new")
            except PermissionError as error:
                os._exit(7 if error.strerror == "it is protected against writing" else 8)
            finally:
                os._exit(9)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        assert path.read_text() == "root's"
