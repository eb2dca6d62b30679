"""Law: the live page refuses the files that Recording.load refuses, in the same sentences."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv.recording.stored import FORMAT

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def said_of(answer_of_node, wasm):
    def asked(paths: list[Path]) -> list[dict]:
        question = {"wasm": str(wasm), "format": FORMAT, "paths": [str(path) for path in paths]}
        return answer_of_node(question, "tests/web/read_files.mjs")

    return asked


@pytest.fixture(scope="module")
def recording() -> flockenv.Recording:
    parameters = flockenv.FlockParameters(n_boats=5, n_leaders=2, discs=((120, 0, 5),))
    return flockenv.simulate(parameters, 3, 6.0, contacts=True)


def refusal_of(path: Path) -> str | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            flockenv.Recording.load(path)
        except flockenv.ParameterError as error:
            return str(error)
    return None


@pytest.mark.parametrize("compressed", [False, True])
def test_flipped_bytes(recording, said_of, tmp_path, compressed):
    whole = tmp_path / "whole.npz"
    recording.save(whole, compressed=compressed)
    content = whole.read_bytes()
    random = np.random.default_rng(1)
    paths = []
    for number in range(500):
        harmed = bytearray(content)
        harmed[random.integers(len(content))] ^= int(random.integers(1, 256))
        paths.append(tmp_path / f"{number}.npz")
        paths[-1].write_bytes(harmed)
    refused = [refusal_of(path) is not None for path in paths]
    said = said_of([whole, *paths])
    assert said[0]["refusal"] is None
    assert sum(refused) > 450
    for path, is_refused, each in zip(paths, refused, said[1:], strict=True):
        if is_refused:
            assert each["refusal"] is not None, path.name
            faults = (
                "a complete, undamaged .npz file: ",
                "an .npz file, in which",
                "a recording of flockenv: ",
            )
            assert each["refusal"].startswith(tuple(f"{path} is not {fault}" for fault in faults))


def changes(recording: flockenv.Recording) -> dict[str, dict]:
    """Arrays that a harmed file has in place of those of a whole one; None for none."""
    return {
        **changed_origins(recording),
        **changed_times(recording.time_s),
        **changed_motions(recording),
        **changed_series(recording),
        **changed_contacts(recording.contacts),
        **changed_names(recording),
    }


def changed_origins(recording: flockenv.Recording) -> dict[str, dict]:
    toml = recording.parameters.to_toml()
    return {
        "another format": {"format": np.array("flockenv recording 999")},
        "no parameters": {"parameters": None},
        "no poses": {"pose": None, "velocity": None},
        "half of the contacts": {"contacts_force": None},
        "a format that is a number": {"format": np.array(2)},
        "a list of policies": {"policy": np.array(["a", "b"])},
        "a signed seed": {"seed": np.array(3, np.int64)},
        "a duration in single precision": {"duration_s": np.array(6.0, np.float32)},
        "a duration without end": {"duration_s": np.array(1e300)},
        "two durations": {"duration_s": np.array([6.0, 6.0])},
        "a signed seed of noise": {"noise_seed": np.array(3, np.int64)},
        "a rate in whole numbers": {"control_hz": np.array(10)},
        "a rate of 0": {"control_hz": np.array(0.0)},
        "a rate without end": {"control_hz": np.array(np.inf)},
        "a rate that is not a number": {"control_hz": np.array(np.nan)},
        "a short digest": {"start_sha256": np.array("ab12")},
        "two digests": {"schedule_sha256": np.array(["a" * 64, "b" * 64])},
        "parameters out of range": {
            "parameters": np.array(toml.replace("n_boats = 5", "n_boats = 0"))
        },
        "noise that is not a number": {"parameters": np.array(toml.replace("bw_s = ", "bw_s = -"))},
    }


def changed_times(time: np.ndarray) -> dict[str, dict]:
    return {
        "times that run backwards": {"time_s": time[::-1].copy()},
        "times that stand still": {"time_s": np.where(time > 3, 3.0, time)},
        "times before the start": {"time_s": time - 1.0},
        "times beyond the end": {"time_s": time + 1.0},
        "times that are not numbers": {"time_s": np.where(time > 3, np.nan, time)},
        "times in single precision": {"time_s": time.astype(np.float32)},
    }


def changed_motions(recording: flockenv.Recording) -> dict[str, dict]:
    far = np.full_like(recording.pose, 1e300)
    return {
        "poses that are not numbers": {"pose": half_there(recording)},
        "velocities without end": {"velocity": np.full_like(recording.velocity, np.inf)},
        "fewer poses": {"pose": recording.pose[:-1]},
        "poses of more boats": {"pose": np.zeros((len(recording), 6, 3))},
        "poses out of reach": {"pose": far},
        "velocities out of reach": {"velocity": -far},
        "poses in whole numbers": {"pose": recording.pose.astype(np.int64)},
        "velocities in single precision": {"velocity": recording.velocity.astype(np.float32)},
    }


def half_there(recording: flockenv.Recording) -> np.ndarray:
    """Return poses of which one lacks a number."""
    pose = recording.pose.copy()
    pose[3, 1, 0] = np.nan
    return pose


def changed_series(recording: flockenv.Recording) -> dict[str, dict]:
    n = len(recording)
    return {
        "unknown phases": {"phase": np.full(n, "fwd")},
        "longer names of phases": {"phase": recording.phase.astype("<U8")},
        "phases that are not there": {"phase": np.full(n, "", "<U4")},
        "a window in numbers": {"in_analysis_window": np.zeros(n)},
        "an order that is not a number": {"order_psi_o": np.full(n, np.nan)},
        "an order above its range": {"order_psi_o": np.full(n, 1.5)},
        "an angle below its range": {"order_phi_v": np.full(n, -4.0)},
        "an order without end": {"order_phi_o": np.full(n, np.inf)},
        "a longer order": {"order_psi_o": np.zeros(n + 1)},
        "an order in single precision": {"order_psi_o": np.zeros(n, np.float32)},
        "rudders of three leaders": {"rudder": np.zeros((n, 3))},
        "rudders beyond their range": {"rudder": np.full((n, 2), 1.5)},
        "an own quantity with a taken name": {"quantity_psi_o": np.zeros(n)},
        "an own quantity without a name": {"quantity_1st": np.zeros(n)},
        "an own quantity in whole numbers": {"quantity_own": np.zeros(n, np.int64)},
        "a short own quantity": {"quantity_own": np.zeros(2)},
    }


def changed_contacts(contacts: flockenv.ContactSeries) -> dict[str, dict]:
    return {
        "contacts of more boats": {"contacts_i": contacts.i + 5},
        "contacts of no obstacle": {"contacts_j": np.full_like(contacts.j, -9)},
        "contacts that pull": {"contacts_force": -contacts.force},
        "more contacts than there are": {"contacts_count": contacts.count + 1},
        "contacts that are not numbers": {"contacts_normal": contacts.normal * np.nan},
        "contacts in double precision": {"contacts_force": contacts.force.astype(np.float64)},
    }


def changed_names(recording: flockenv.Recording) -> dict[str, dict]:
    return {
        "fewer names than boats": {"ids": np.array(["a", "b"])},
        "names twice": {"ids": np.array(["a"] * 5)},
        "names that are numbers": {"ids": np.arange(5)},
        "a boat that is half there": {"ids": np.array([*"abcde"]), "pose": half_there(recording)},
        "unsolved substeps that are a list": {"statistics_unsolved": np.array([0, 0])},
        "a deepest overlap that is a text": {"statistics_worst_overlap_cm": np.array("0")},
    }


def test_what_is_no_recording_is_refused_by_the_same_sentence(recording, said_of, tmp_path):
    recording.save(tmp_path / "whole.npz")
    with np.load(tmp_path / "whole.npz") as file:
        whole = dict(file)
    expected = {}
    for name, changed in changes(recording).items():
        arrays = {key: array for key, array in {**whole, **changed}.items() if array is not None}
        path = tmp_path / f"{name}.npz"
        np.savez(path, **arrays)
        expected[path] = refusal_of(path)
    said = said_of(list(expected))
    for (path, sentence), each in zip(expected.items(), said, strict=True):
        assert sentence is not None, path.stem
        assert each["refusal"] == sentence


def test_many_discs_and_walls_are_no_fault(said_of, tmp_path):
    far = [(1e5 + 100 * k, 0.0, 5.0) for k in range(1000)]
    walls = [(x, 50.0, x + 10.0, 50.0) for x, *_ in far]
    parameters = flockenv.FlockParameters(n_boats=3, pool=(np.inf, 0), discs=far, walls=walls)
    path = tmp_path / "many.npz"
    flockenv.simulate(parameters, 1, 1.0).save(path)
    assert said_of([path])[0]["refusal"] is None


def test_arrays_by_columns_and_all_origins_are_no_fault(recording, said_of, tmp_path):
    path, whole = tmp_path / "columns.npz", tmp_path / "whole.npz"
    recording.save(whole)
    origin = {"noise_seed": np.array(2**64 - 1, np.uint64), "control_hz": np.array(2.5)}
    origin |= {"start_sha256": np.array("a" * 64), "schedule_sha256": np.array("0" * 64)}
    with np.load(whole) as file:
        arrays = {name: np.array(file[name], order="F") for name in file if "order" not in name}
    np.savez(path, **arrays, **origin)
    assert refusal_of(path) is None
    full, same = said_of([whole, path])
    assert same["refusal"] is None
    assert np.allclose(same["signed"], full["signed"], atol=1e-12)


def test_a_quantity_that_is_not_stored_is_computed(recording, said_of, tmp_path):
    path, whole = tmp_path / "less.npz", tmp_path / "whole.npz"
    recording.save(whole)
    with np.load(whole) as file:
        np.savez(path, **{name: file[name] for name in file if name != "order_psi_o"})
    full, less = said_of([whole, path])
    assert less["refusal"] is None
    assert np.allclose(full["signed"], recording.order.signed_order("cw"), atol=1e-12)
    assert np.allclose(less["signed"], full["signed"], atol=1e-12)
