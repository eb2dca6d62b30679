"""A finished run is stored whole and comes back bit for bit; whatever else lies there is named."""

import json
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries
from flockenv.errors import FlockError
from flockenv.order import ORDER
from flockenv.recording import RecordingWarning
from flockenv.runs import store as run_store
from flockenv.runs.spec import KEEP, RunSpec, execute
from flockenv.runs.store import RunStore, StorageError, StoreWarning, run_missing
from flockenv.runs.sweep import summary


@pytest.fixture
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(n_boats=6, pool="narrow")


@pytest.fixture
def spec(parameters: flockenv.FlockParameters) -> RunSpec:
    return RunSpec(parameters=parameters, seed=3, duration_s=30.0)


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path)


@pytest.mark.parametrize("keep", KEEP)
def test_a_kept_run_comes_back(
    parameters: flockenv.FlockParameters, store: RunStore, keep: str
) -> None:
    spec = RunSpec(parameters=parameters, seed=3, duration_s=30.0, keep=keep)
    assert store.load(spec) is None
    result = execute(spec)
    store.save(spec, result)
    loaded = store.load(spec)
    assert loaded is not None
    assert loaded == result
    recording = flockenv.simulate(parameters, 3, 30.0)
    frames = np.ones(301, bool)
    if keep == "window":
        frames = recording.in_analysis_window & (recording.time_s > 3.0)
        assert loaded.analyzed() == loaded
    assert (loaded.time_s == recording.time_s[frames]).all()
    for name in ORDER:
        single = getattr(recording.order, name)[frames].astype(np.float32)
        assert (getattr(loaded.order, name) == single).all()
    if keep == "poses":
        assert (loaded.pose == recording.pose.astype(np.float32)).all()


def test_all_that_a_result_depends_on_is_in_the_key(spec: RunSpec) -> None:
    base = {name: getattr(spec, name) for name in ("parameters", "seed", "duration_s", "sample_hz")}
    changes = [
        {},
        {"seed": 4},
        {"duration_s": 31.0},
        {"sample_hz": 5.0},
        {"keep": "order"},
        {"parameters": spec.parameters.replace(c4=0.11)},
    ]
    assert len({RunSpec(**base | change).key for change in changes}) == len(changes)
    assert RunSpec(**base).key == spec.key


def test_the_policy_of_a_spec_is_at_the_start_of_a_run(
    parameters: flockenv.FlockParameters,
) -> None:
    steered = parameters.replace(n_leaders=1)
    spec = RunSpec(parameters=steered, seed=3, duration_s=30.0, policy="random rudders")
    size = len(observation_entries())
    drawn, again = (spec.checked_policy.predict(np.zeros(size))[0] for _ in range(2))
    assert np.array_equal(drawn, again)


@pytest.mark.parametrize("damage", ["cut", "flip", "nonsense", "empty"])
def test_damage_is_named_and_kept(spec: RunSpec, store: RunStore, damage: str) -> None:
    store.save(spec, execute(spec))
    whole = store.path(spec).read_bytes()
    middle = len(whole) // 2
    flipped = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    broken = {"cut": whole[:middle], "flip": flipped, "nonsense": b"no run", "empty": b""}[damage]
    store.path(spec).write_bytes(broken)
    with pytest.warns(StoreWarning, match=spec.key):
        assert store.load(spec) is None
    assert store.path(spec).with_suffix(".damaged").read_bytes() == broken
    assert run_missing([spec], store) == {}
    assert store.path(spec).read_bytes() == whole


def changed(path: Path, change: Callable[[dict[str, Any]], Any]) -> bytes:
    """Change the arrays of a stored run, and return the bytes of the file."""
    with np.load(path) as arrays:
        stored = dict(arrays)
    change(stored)
    np.savez(path, **stored)
    return path.read_bytes()


def words_of(resume: Callable[[], dict[RunSpec, FlockError]]) -> list[str]:
    """Resume from whole runs, and return what Python prints of what recordings have or lack."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default", RecordingWarning)
        assert resume() == {}
    return [str(each.message).rsplit(": ")[1] for each in said]


@pytest.mark.filterwarnings("ignore::flockenv.recording.RecordingWarning")
@pytest.mark.parametrize("keep", KEEP)
def test_runs_with_more_or_less_are_read_and_stay(spec: RunSpec, tmp_path: Path, keep: str) -> None:
    """A build with one quantity more or less resumes from the runs of another."""
    store, spec = RunStore(tmp_path), replace(spec, keep=keep)
    store.save(spec, execute(spec))
    less = changed(store.path(spec), lambda arrays: arrays.pop("order_nematic"))
    undefined = [] if keep == "poses" else ["order_nematic"]
    assert words_of(lambda: run_missing([spec], store)) == undefined
    run = store.load(spec)
    assert run is not None
    assert np.isnan(run.order.nematic).all() == (keep != "poses")
    assert np.isnan(summary(run)["nematic_mean"]) == (keep != "poses")
    assert store.path(spec).read_bytes() == less
    more = changed(store.path(spec), lambda arrays: arrays.update(order_unknown=arrays["time_s"]))
    assert words_of(lambda: run_missing([spec], store)) == ["order_unknown", *undefined]
    assert store.path(spec).read_bytes() == more


def test_runs_that_lack_the_same_are_one_word(spec: RunSpec, store: RunStore) -> None:
    specs = [replace(spec, seed=seed) for seed in range(5)]
    for each in specs:
        store.save(each, execute(each))
        changed(store.path(each), lambda arrays: arrays.pop("order_nematic"))
    assert words_of(lambda: run_missing(specs, store)) == ["order_nematic"]


def test_a_run_that_lacks_what_cannot_be_computed_is_named_and_stays(
    spec: RunSpec, store: RunStore
) -> None:
    store.save(spec, execute(spec))
    stored = changed(store.path(spec), lambda arrays: arrays.pop("phase"))
    for attempt in (lambda: store.load(spec), lambda: run_missing([spec], store)):
        with pytest.raises(flockenv.ParameterError, match=f"{spec.key}.*missing: phase"):
            attempt()
    assert store.path(spec).read_bytes() == stored


def test_a_key_holds_what_differs_from_the_defaults(spec: RunSpec) -> None:
    """One parameter more, at its default, gives no stored run another name."""
    parameters = {"n_boats": 6, "pool": "narrow"}
    assert json.loads(spec.to_json()) == {"parameters": parameters, "seed": 3, "duration_s": 30.0}


@pytest.mark.parametrize("name", ["RESULTS_VERSION", "__version__"])
def test_runs_of_another_version_are_missing_and_stay(
    spec: RunSpec, store: RunStore, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(run_store if name.isupper() else run_store._core, name, "0.0.7")
        store.save(spec, execute(spec))
        old = store.path(spec)
    assert store.load(spec) is None
    run_missing([spec], store)
    assert store.load(spec) is not None
    assert old.exists()


def test_equal_specs_have_equal_keys(spec: RunSpec) -> None:
    """Negative zero equals zero."""
    plus, minus = (
        RunSpec(parameters=spec.parameters.replace(c4=c4), seed=3, duration_s=30.0)
        for c4 in (0.0, -0.0)
    )
    assert plus == minus
    assert plus.key == minus.key
    assert "-0.0" not in minus.to_json()


def test_a_run_under_a_wrong_name_is_not_taken(spec: RunSpec, store: RunStore) -> None:
    other = RunSpec(parameters=spec.parameters, seed=4, duration_s=30.0)
    store.save(other, execute(other))
    store.path(spec).parent.mkdir(exist_ok=True)
    store.path(other).rename(store.path(spec))
    with pytest.warns(StoreWarning, match="another run"):
        assert store.load(spec) is None


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"specs": "abc"}, "specs must be a sequence"),
        ({"workers": 0}, "workers = 0"),
        ({"workers": 1.5}, "workers = 1.5 is not accepted: a whole number"),
        ({"progress": None}, "progress must be a function"),
    ],
)
def test_runs_that_cannot_be_made_are_refused_first(spec, store, changes, words) -> None:
    with pytest.raises((TypeError, flockenv.ParameterError), match=words):
        run_missing(**{"specs": [spec], "store": store, **changes})
    assert not store.path(spec).exists()


def test_missing_runs_are_made_and_failures_cost_no_others(spec: RunSpec, store: RunStore) -> None:
    impossible = RunSpec(parameters=spec.parameters.replace(n_boats=900), seed=0, duration_s=30.0)
    seen: list[RunSpec] = []
    failures = run_missing([impossible, spec, spec], store, progress=seen.append)
    assert list(failures) == [impossible]
    assert "fit" in str(failures[impossible])
    assert set(seen) == {spec, impossible}
    before = store.path(spec).stat().st_mtime_ns
    assert run_missing([spec], store) == {}
    assert store.path(spec).stat().st_mtime_ns == before


def test_the_number_of_workers_may_be_a_whole_float(spec: RunSpec, store: RunStore) -> None:
    assert run_missing([spec], store, workers=2.0) == {}  # type: ignore[arg-type]


def test_a_damaged_file_that_cannot_be_renamed_is_named(spec: RunSpec, store: RunStore) -> None:
    path = store.path(spec)
    path.with_suffix(".damaged").mkdir(parents=True)
    path.write_bytes(b"no run")
    with pytest.raises(StorageError, match=f"{spec.key}.*cannot be renamed"):
        store.load(spec)
    assert path.read_bytes() == b"no run"


def test_an_unwritable_folder_is_named(spec: RunSpec, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StorageError, match="file"):
        RunStore(tmp_path / "file").save(spec, execute(spec))


def test_a_run_that_cannot_be_read_is_named_and_stays(spec: RunSpec, store: RunStore) -> None:
    # Also root may not read a folder as a file.
    store.path(spec).mkdir(parents=True)
    with pytest.raises(StorageError, match=f"{spec.key}.*cannot be read"):
        store.load(spec)
    assert store.path(spec).is_dir()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"keep": "all"}, "window, order, poses"),
        ({"policy": "lernd"}, "did you mean 'learned'"),
        ({"seed": -1}, "seed"),
        ({"duration_s": float("nan")}, "duration_s"),
        ({"sample_hz": 0}, "sample_hz"),
        ({"duration_s": 1e300}, "at most 1e"),
        ({"duration_s": 10**400}, "at most 1e"),
        ({"duration_s": "30"}, "duration_s must be a number"),
        ({"sample_hz": True}, "sample_hz must be a number"),
        ({"parameters": {}}, "parameters must be FlockParameters"),
    ],
)
def test_a_spec_is_checked(
    parameters: flockenv.FlockParameters, change: dict[str, object], words: str
) -> None:
    values = {"parameters": parameters, "seed": 1, "duration_s": 30.0} | change
    with pytest.raises((flockenv.ParameterError, TypeError), match=words):
        RunSpec(**values)  # type: ignore[arg-type]


PINNED = {
    "leapfrog": (0.2290381475, 0.0243453833),
    "moreau": (0.2245344472, 0.0362720621),
    "paper": (0.2154582107, -0.0902647887),
}
"""Ψ_o and φ_o of one short run."""


def test_the_numbers_belong_to_this_results_version() -> None:
    """If the physics changed on purpose: raise RESULTS_VERSION, then pin the new numbers."""
    parameters = flockenv.FlockParameters.preset("simulation").replace(n_boats=20, pool="narrow")
    for scheme, numbers in PINNED.items():
        order = flockenv.simulate(parameters.replace(scheme=scheme), seed=5, duration_s=6.0).order
        assert (order.psi_o[-1], order.phi_o[-1]) == pytest.approx(numbers, abs=1e-6)
    assert run_store.RESULTS_VERSION == 8


@pytest.mark.parametrize("keep", KEEP)
@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"duration_s": 60.0}, "60 s, not 30 s"),
        ({"duration_s": 15.0}, "15 s, not 30 s"),
        ({"sample_hz": 5.0}, "other samples than 10 per second"),
        ({"sample_hz": 20.0}, "other samples than 10 per second"),
        ({"sample_hz": 7.0}, "other samples than 10 per second"),
        ({"policy": "straight ahead"}, "a policy StraightAhead"),
        ({"policy": "paper's law"}, "a policy SteeringLaw"),
        ({"policy": "learned"}, "a policy LeaningLaw.* sha256:"),
        ({"seed": 4}, "seed 4, not 3"),
    ],
)
def test_a_run_of_another_spec_is_not_taken(spec, tmp_path, keep, other, words) -> None:
    spec = replace(spec, keep=keep, parameters=spec.parameters.replace(n_leaders=2, pool="wide"))
    notes: list[str] = []
    store = RunStore(tmp_path, notes.append)
    store.save(spec, execute(replace(spec, **other)))
    assert store.load(spec) is None
    assert re.search(words, notes[0])
    assert run_missing([spec], store, workers=1) == {}
    assert store.load(spec) == execute(spec)
    assert len(notes) == 1


def test_a_branch_a_scheduled_run_and_one_from_another_start_are_not_the_plain_run(spec, tmp_path):
    spec = replace(spec, keep="poses")
    plain, flock = execute(spec), flockenv.Flock(spec.parameters, spec.seed)
    begun = flock.snapshot()
    flock.advance(1.0)
    others = {
        "noise_seed 5": {"start": begun, "noise_seed": 5},
        "start_sha256 ": {"start": {"pose": flock.pose}},
        "schedule_sha256 ": {"schedule": [(10.0, {"bw_s": 0.9})]},
    }
    for words, how in others.items():
        notes: list[str] = []
        store = RunStore(tmp_path / words.split()[0], notes.append)
        run = flockenv.simulate(spec.parameters, spec.seed, 30.0, dtype=np.float32, **how)
        store.save(spec, replace(run, rudder=None, order=plain.order))
        assert store.load(spec) is None
        assert words in notes[0]


@pytest.mark.parametrize("other", KEEP)
@pytest.mark.parametrize("keep", KEEP)
def test_a_run_of_which_other_things_were_kept_is_not_taken(spec, tmp_path, keep, other) -> None:
    spec, store = replace(spec, keep=keep), RunStore(tmp_path, lambda line: None)
    store.save(spec, execute(replace(spec, keep=other)))
    assert (store.load(spec) is not None) == (keep == other)


@pytest.mark.parametrize("duration_s", [0.05, 1.0, 7.0, 30.0, 33.333])
@pytest.mark.parametrize("sample_hz", [0.3, 1.0, 3.0, 10.0, 33.0, 100.0])
@pytest.mark.parametrize("keep", KEEP)
def test_every_run_that_was_kept_is_its_own(spec, store, keep, sample_hz, duration_s) -> None:
    spec = replace(spec, keep=keep, sample_hz=sample_hz, duration_s=duration_s)
    store.save(spec, execute(spec))
    assert store.load(spec) == execute(spec)


def test_a_short_run_with_a_sample_in_each_of_two_windows_is_its_own(spec, store) -> None:
    """The first tenth cuts the first window to the sample at 1 s, the end the second to 6.5 s."""
    phases = {"fw_s": 1.0, "nop1_s": 1.0, "bw_s": 3.0, "nop2_s": 1.0}
    parameters = spec.parameters.replace(**phases)
    spec = replace(spec, parameters=parameters, sample_hz=2.0, duration_s=6.5)
    run = execute(spec)
    assert run.time_s.tolist() == [1.0, 6.5]
    store.save(spec, run)
    assert store.load(spec) == run


def test_resuming_removes_what_killed_processes_left(spec, store) -> None:
    folder = store.path(spec).parent
    folder.mkdir(parents=True)
    (folder / ".0123456789abcdef.tmp").write_bytes(b"half a run")
    run_missing([spec], store, workers=1)
    assert [path.name for path in folder.iterdir()] == [store.path(spec).name]


def test_failures_hold_no_recordings(spec, tmp_path) -> None:
    """A motion that leaves its range fails on the way, and its run would stay in memory."""
    wild = spec.parameters.replace(c0=1e6, c1=0.0, c2=1e6, c3=0.0, speed_cm_s=1e6, turning_bias=1.0)
    spec = replace(spec, parameters=wild)
    with pytest.raises(flockenv.SolverError) as raised:
        execute(spec)
    assert len(raised.value.recording) > 0
    failures = run_missing([spec], RunStore(tmp_path), workers=1)
    assert not hasattr(failures[spec], "recording")
