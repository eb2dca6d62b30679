"""Law: a recording names its noise, start, schedule and rate: other runs have other origins."""

import hashlib

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters, ParameterError, Recording, simulate
from flockenv.recording.checks import ORIGIN

PARAMETERS = FlockParameters(n_boats=7, n_leaders=1, pool="narrow")


def origin_of(run):
    return {name: getattr(run, name) for name in ORIGIN}


@pytest.fixture(scope="module")
def flock():
    flock = flockenv.Flock(PARAMETERS, seed=7)
    flock.advance(3.0)
    return flock


@pytest.fixture(scope="module")
def runs(flock):
    blob, state = flock.snapshot(), {"pose": flock.pose, "velocity": flock.velocity}
    ways = {
        "plain": {},
        "from a snapshot": {"start": blob},
        "noise 5": {"start": blob, "noise_seed": 5},
        "noise 6": {"start": blob, "noise_seed": np.int64(6)},
        "from a state": {"start": state},
        "from a state at rest": {"start": {"pose": flock.pose}},
        "at another time": {"start": state | {"time_s": 9.0}},
        "a ramp": {"schedule": [(0.5, {"bw_s": 0.6}), (1.0, {"bw_s": 0.9})]},
        "a later ramp": {"schedule": [(0.5, {"bw_s": 0.6}), (1.5, {"bw_s": 0.9})]},
        "a turn": {"schedule": [(1.0, {"target": "ccw"})]},
        "decisions": {"policy": "tuned law"},
        "fewer decisions": {"policy": "tuned law", "control_hz": 2},
    }
    return {name: simulate(PARAMETERS, 7, 2.0, **way) for name, way in ways.items()}


def test_runs_that_differ_have_another_origin_or_policy(runs):
    found = {(run.policy, *origin_of(run).values()) for run in runs.values()}
    assert len(found) == len(runs)


def test_a_plain_run_has_none(runs):
    assert set(origin_of(runs["plain"]).values()) == {None}


def test_the_digest_of_a_snapshot_is_that_of_its_bytes(runs, flock):
    digest = hashlib.sha256(flock.snapshot()).hexdigest()
    assert {runs[name].start_sha256 for name in ("from a snapshot", "noise 5")} == {digest}
    assert runs["noise 6"].noise_seed == 6


def test_a_state_has_one_digest_however_it_is_given(runs):
    from_recording = simulate(PARAMETERS, 8, 1.0, start=runs["plain"])
    state = runs["plain"].state_at(2.0)
    assert from_recording.start_sha256 == simulate(PARAMETERS, 9, 1.0, start=state).start_sha256


def test_the_order_of_the_entries_of_a_schedule_changes_nothing(runs):
    entries = [(1.0, {"bw_s": 0.9}), (0.5, {"bw_s": 0.6})]
    again = simulate(PARAMETERS, 7, 2.0, schedule=entries)
    assert again.schedule_sha256 == runs["a ramp"].schedule_sha256


def test_a_schedule_counts_as_far_as_it_came(flock):
    later, both = (
        [(0.5, {"bw_s": 0.6})],
        [(0.5, {"bw_s": 0.6}), (1.0, {"discs": [(0.0, 0.0, 45.0)]})],
    )
    pool = PARAMETERS.replace(pool=(90.0, 0.0), n_boats=27)
    with pytest.raises(ParameterError, match="overlap") as raised:
        simulate(pool, 3, 4.0, schedule=both)
    assert raised.value.recording == simulate(pool, 3, 1.0, schedule=later)


def test_files_tables_and_parts_keep_it(runs, tmp_path):
    for number, run in enumerate(runs.values()):
        run.save(tmp_path / f"{number}.npz")
        back = Recording.load(tmp_path / f"{number}.npz")
        assert back == run
        assert origin_of(back) == origin_of(run)
        assert origin_of(run.analyzed().without_poses()) == origin_of(run)
        named = {name: value for name, value in origin_of(run).items() if value is not None}
        assert {name: run.to_xarray().attrs.get(name) for name in named} == named
        assert ORIGIN.keys() & run.to_xarray().attrs.keys() == named.keys()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("noise_seed", np.array(-1)),
        ("noise_seed", np.array(1.5)),
        ("noise_seed", np.array([1], np.uint64)),
        ("control_hz", np.array(0.0)),
        ("control_hz", np.array(np.nan)),
        ("control_hz", np.array("2")),
        ("start_sha256", np.array("")),
        ("start_sha256", np.array("A" * 64)),
        ("schedule_sha256", np.array(7)),
    ],
)
def test_an_origin_that_no_run_has_is_refused_by_name(runs, tmp_path, name, value):
    file = tmp_path / "run.npz"
    runs["plain"].save(file)
    with np.load(file) as stored:
        arrays = dict(stored)
    np.savez(file, **{**arrays, name: value})
    with pytest.raises(ParameterError, match=name):
        Recording.load(file)
