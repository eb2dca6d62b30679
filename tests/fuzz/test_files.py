"""Law: whatever a file holds, a named error or what was saved; nothing in it is executed, and no
writer leaves half a file."""

import io
import os
import tracemalloc
import zipfile
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from flockenv import FlockError, FlockParameters, ParameterError, Recording, simulate
from flockenv._io import array_file
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.cli.parameters import OneFlock
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy, load
from flockenv.rendering import save_animation
from flockenv.replay import write_replay
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.store import RunStore
from flockenv.runs.sweep import read_sweep

FUZZ = settings.get_profile("fuzz")
PARAMETERS = FlockParameters(n_boats=4, n_leaders=1, pool="narrow")
RUN = simulate(PARAMETERS, 1, 0.5, contacts=True)
SPEC = RunSpec(parameters=PARAMETERS, seed=1, duration_s=5.0, keep="poses")
RESULT = execute(SPEC)
SIZE = len(observation_entries())
POLICY = NetworkPolicy([np.full((SIZE, 1), 0.1)], [[0.25]], provenance={"seed": "7"})
SWEEP = """
minutes = 0.1
seeds = 2
[fixed]
pool = "narrow"
[[grid]]
n_boats = [4, 5]
bw_s = [0.0, 0.2]
"""


def same_policy(found) -> bool:
    return found.weights[0].tobytes() == POLICY.weights[0].tobytes()


#: How a kind of file is written, read, and whether what was read is what was written.
KINDS = {
    "recording": (RUN.save, Recording.load, lambda found: found == RUN),
    "policy": (POLICY.save, load, same_policy),
    "sweep": (
        lambda path: Path(path).write_text(SWEEP),
        read_sweep,
        lambda found: len(found.runs) == 8,
    ),
    "parameters": (
        lambda path: Path(path).write_text(PARAMETERS.to_toml()),
        lambda path: OneFlock(params=path).parameters(),
        lambda found: found == PARAMETERS,
    ),
}
kinds = st.sampled_from(sorted(KINDS))
archives = st.sampled_from(["recording", "policy"])


@cache
def written(kind: str) -> bytes:
    with TemporaryDirectory() as folder:
        path = Path(folder, "file.npz")
        KINDS[kind][0](path)
        return path.read_bytes()


def read(kind: str, blob: bytes):
    """What is read from a file of these bytes; None where a named error is raised."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "file.npz")
        path.write_bytes(blob)
        try:
            return KINDS[kind][1](path)
        except FlockError:
            return None


@FUZZ
@given(archives, st.floats(0, 1, exclude_max=True))
def test_cut_off_archives(kind, share):
    assert read(kind, written(kind)[: int(share * len(written(kind)))]) is None


@FUZZ
@given(archives, st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255))))
def test_archives_with_changed_bytes(kind, changes):
    blob = bytearray(written(kind))
    for share, bits in changes:
        blob[int(share * len(blob))] ^= bits
    found = read(kind, bytes(blob))
    assert found is None or KINDS[kind][2](found)


@FUZZ
@given(st.sampled_from(["sweep", "parameters"]), st.data())
def test_changed_texts(kind, data):
    text = written(kind)
    start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(text))] * 2)))
    read(kind, text[:start] + data.draw(st.binary(max_size=10)) + text[end:])


@FUZZ
@given(kinds, kinds)
def test_files_of_another_kind(kind, other):
    if kind != other:
        assert read(kind, written(other)) is None


@FUZZ
@given(kinds, st.binary(max_size=200))
def test_foreign_bytes(kind, blob):
    read(kind, blob)


TRAP = Path(gettempdir(), f"flockenv-trap-{os.getpid()}")


class Trap:
    def __reduce__(self):
        return Path.touch, (TRAP,)


HOSTILE_ARRAYS = (
    np.array([Trap()], dtype=object),
    np.array(1.0),
    np.full((3, 4, 3), np.nan),
    np.zeros((0, 4, 3)),
    np.array("[" * 100_000),
    np.array("{}"),
    np.array("n_boats = 1" + "0" * 5000),
    np.array(["fw"] * 6),
    np.array([b"bytes"]),
    np.zeros(3, "datetime64[s]"),
    np.zeros(2, [("a", "f8")]),
    np.array([2**64 - 1], np.uint64),
    np.array(True),
)


def replaced(blob: bytes, changes) -> bytes:
    """An archive with some arrays replaced by their place in it; None leaves them out."""
    with np.load(io.BytesIO(blob), allow_pickle=False) as arrays:
        names = list(arrays)
        content = dict(arrays)
    for place, array in changes.items():
        name = names[place % len(names)]
        content[name] = array
        if array is None:
            del content[name]
    file = io.BytesIO()
    np.savez(file, **content)
    return file.getvalue()


@FUZZ
@given(
    archives,
    st.dictionaries(
        st.integers(0, 40), st.one_of(st.none(), st.sampled_from(HOSTILE_ARRAYS)), min_size=1
    ),
)
@example("recording", {0: np.array(1.0)})
@example("recording", {0: HOSTILE_ARRAYS[0]})
def test_archives_with_foreign_arrays(kind, changes):
    found = read(kind, replaced(written(kind), changes))
    assert not TRAP.exists()
    if kind == "recording" and found is not None:
        assert np.isfinite(found.pose).all()


def archive(names, entry: bytes, method: int, claims: int | None = None) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as target:
        for name in names:
            target.writestr(f"{name}.npy", entry)
        for info in target.infolist() if claims is not None else ():
            info.file_size = claims
    return file.getvalue()


@FUZZ
@given(
    archives,
    st.sampled_from([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA]),
    st.lists(st.one_of(st.integers(-1, 5), st.sampled_from([2**31, 10**12, 2**62])), max_size=3),
    st.sampled_from(["<f8", "<i8", "|b1", "<U4", "<U0", "<U2147483647", "|O", "|V0", "<M8[s]"]),
    st.one_of(st.none(), st.sampled_from([8 * 10**12, 2**33])),
)
def test_headers_that_claim_the_world(kind, method, shape, descr, claims):
    header = str({"descr": descr, "fortran_order": False, "shape": tuple(shape)}).encode()
    entry = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header
    assert read(kind, archive(["pose", "header", "time_s"], entry, method, claims)) is None


def test_an_archive_that_would_fill_the_memory_is_refused_unread(tmp_path):
    (tmp_path / "bomb.npz").write_bytes(
        archive(["pose"], os.urandom(2 << 20), zipfile.ZIP_DEFLATED, claims=20 << 30)
    )
    with pytest.raises(ParameterError, match="it holds 21474836480 bytes"):
        read_arrays(tmp_path / "bomb.npz")


def test_zeros_that_would_fill_the_memory_are_refused_unread(tmp_path):
    """A hundred times the file, and at least 64 MiB, are accepted; zeros take a thousandth."""
    entry = io.BytesIO()
    np.save(entry, np.zeros(20_000_000))
    blob = archive(["pose"], entry.getvalue(), zipfile.ZIP_DEFLATED)
    del entry
    assert len(blob) < 1 << 20
    (tmp_path / "bomb.npz").write_bytes(blob)
    tracemalloc.start()
    try:
        with pytest.raises(ParameterError, match=f"160000128 bytes of {64 << 20} that are"):
            Recording.load(tmp_path / "bomb.npz")
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()


def test_a_file_that_says_less_than_it_holds_fills_no_memory(tmp_path):
    """Its directory, which anybody may write, counts 100 bytes of 40 MB of zeros."""
    path = tmp_path / "a.npz"
    np.savez_compressed(path, seed=np.zeros(5_000_000))
    data = bytearray(path.read_bytes())
    size = data.rindex(b"PK\x01\x02") + 24
    data[size : size + 4] = (100).to_bytes(4, "little")
    path.write_bytes(data)
    tracemalloc.start()
    try:
        with pytest.raises(ParameterError, match="not a complete, undamaged"):
            Recording.load(path)
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()


def test_what_is_written_is_read_however_little_it_takes(tmp_path, monkeypatch):
    """Flocks at rest compress like zeros: they are stored plain, and read again."""
    monkeypatch.setattr(array_file, "_FREE_BYTES", 1000)
    for arrays in ({"rest": np.zeros(100_000)}, {"noise": np.random.default_rng(1).random(1000)}):
        write_arrays(tmp_path / "a.npz", arrays, compressed=True)
        for name, array in read_arrays(tmp_path / "a.npz").items():
            assert np.array_equal(array, arrays[name])
    monkeypatch.undo()
    write_arrays(tmp_path / "b.npz", {"rest": np.zeros(100_000)}, compressed=True)
    assert (tmp_path / "b.npz").stat().st_size < 10_000


WRITERS = {
    "recording": lambda path: RUN.save(path.with_suffix(".npz")),
    "policy": lambda path: POLICY.save(path.with_suffix(".npz")),
    "stored run": lambda path: RunStore(path.parent / "runs").save(SPEC, RESULT),
    "page": lambda path: write_replay(path.with_suffix(".html"), {"run": RUN}),
    "GIF": lambda path: save_animation(
        path.with_suffix(".gif"), [np.zeros((9, 9, 3), np.uint8)], 5.0
    ),
}


def files(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.is_file())
    return {str(path): path.read_bytes() for path in found}


@pytest.mark.parametrize("fails", ["fsync", "replace"])
@pytest.mark.parametrize("writer", WRITERS)
def test_a_disk_that_fails_leaves_what_was_there(writer, fails, tmp_path, monkeypatch):
    WRITERS[writer](tmp_path / "file")
    before = files(tmp_path)
    assert len(before) == 1

    def fail(*_arguments, **_options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(*((os, "fsync", fail) if fails == "fsync" else (Path, "replace", fail)))
    with pytest.raises((FlockError, OSError), match="No space left"):
        WRITERS[writer](tmp_path / "file")
    assert files(tmp_path) == before
