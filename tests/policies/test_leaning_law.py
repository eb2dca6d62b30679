"""LeaningLaw: the damped law about a heading leaned outward by what is seen.

On paper: forward, with a gain g, a lean of b and a leader that heads along the target's tangent,
the rudder is g·1.2·tanh(b/1.2): it turns counter-clockwise, outward, while it moves clockwise.
"""

import json
import math

import numpy as np
import pytest

import flockenv
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.envs.observation import observation_entries
from flockenv.policies import DampedLaw, HiddenUnits, LeaningLaw, load
from flockenv.policies.leaning_law import FEATURES, FURTHER_FEATURES, features

NAMES = [entry.name for entry in observation_entries()]
GAINS = {"gain": 0.5, "backward_gain": 2.0, "damping": 9.0}


def row(**entries: float) -> np.ndarray:
    """An observation of zeros but for a forward leader on the tangent, and some entries."""
    found = np.zeros(len(NAMES), np.float32)
    entries = {"sin_orientation": 1.0, "forward_velocity": 0.5} | entries
    for name, value in entries.items():
        found[NAMES.index(name)] = value
    return found


def visited() -> np.ndarray:
    env = flockenv.LeadersVectorEnv(
        4, n_boats=27, n_leaders=3, pool="narrow", bw_s=0.5, mirror_to_target=True, target="random"
    )
    rows, _ = env.reset(seed=1)
    law, seen = DampedLaw(mirror_to_target=True), []
    for _ in range(300):
        rows, *_ = env.step(law.predict(rows)[0])
        seen.append(rows)
    return np.concatenate(seen)


def test_without_weights_it_is_the_damped_law():
    rows = visited()
    damped = DampedLaw(**GAINS, mirror_to_target=True)
    expected, found = damped.predict(rows)[0], LeaningLaw(GAINS, 0.0, {}).predict(rows)[0]
    assert (np.abs(expected) < 1).mean() > 0.3
    np.testing.assert_allclose(found, expected, atol=2e-5)


@pytest.mark.parametrize(
    ("entries", "weights", "lean"),
    [
        ({}, {}, 0.0),
        ({"radial_position": 0.7}, {"radial_position": 0.5}, 0.35),
        ({"radial_position": 0.7}, {"near_outer_wall": 2.0}, 0.2),
        ({"radial_position": 0.2}, {"near_outer_wall": 2.0}, 0.0),
        ({"mean_sin_orientation": -0.5}, {"mean_sin_orientation": 0.4}, -0.2),
        # One neighbor, a unit ahead, that heads the other way: opposed by 1, near by exp(-1/2).
        (
            {"present": 1.0, "clockwise_distance": 1.0, "cos_relative_heading": -1.0},
            {"near_opposed": 0.3},
            0.3 * math.exp(-0.5),
        ),
        (
            {"present": 1.0, "clockwise_distance": -1.0, "cos_relative_heading": -1.0},
            {"opposed_ahead": 0.3},
            -0.3 * math.exp(-0.5),
        ),
        # A leader counts as one, further off, and not as a normal boat.
        (
            {"present": 1.0, "outward_distance": 2.0, "is_leader": 1.0},
            {"leaders_outward": 0.1, "near_outward": 5.0},
            0.2 * math.exp(-0.5),
        ),
    ],
)
def test_how_far_it_leans(entries, weights, lean):
    rudder = LeaningLaw(GAINS, 0.0, weights).predict(row(**entries))[0]
    assert rudder == pytest.approx(0.5 * 1.2 * math.tanh(lean / 1.2), abs=1e-6)


def test_a_file_keeps_every_bit(tmp_path):
    weights = dict(
        zip(FEATURES, np.random.default_rng(0).normal(0, 0.1, len(FEATURES)), strict=True)
    )
    law = LeaningLaw(GAINS, 0.1, weights, provenance={"seed": "3"})
    law.save(tmp_path / "law.npz")
    again, rows = load(tmp_path / "law.npz"), visited()
    np.testing.assert_array_equal(law.predict(rows)[0], again.predict(rows)[0])
    assert again.provenance == {"seed": "3"}
    assert again.mirror_to_target
    assert repr(again) == repr(law)


def test_how_far_hidden_units_lean():
    # One unit that outputs 0.4·tanh(0.1 + 2·r), and one of 0.3·tanh(-0.2), beside 0.5·r.
    hidden = HiddenUnits({"radial_position": [2.0, 0.0]}, [0.1, -0.2], [0.4, 0.3])
    law = LeaningLaw(GAINS, 0.0, {"radial_position": 0.5}, hidden=hidden)
    for r in (-0.3, 0.0, 0.7):
        lean = 0.5 * r + 0.4 * math.tanh(0.1 + 2.0 * r) + 0.3 * math.tanh(-0.2)
        rudder = law.predict(row(radial_position=r))[0]
        assert rudder == pytest.approx(0.5 * 1.2 * math.tanh(lean / 1.2), abs=1e-6)


def fellows(*angles: float) -> np.ndarray:
    """An observation with fellow leaders at these angles, clockwise."""
    blocks = [[1.0, math.cos(angle), math.sin(angle), 0.0, 0.0, 0.0] for angle in angles]
    blocks += [[0.0] * 6] * (3 - len(angles))
    return np.append(row(), np.float32(blocks))


@pytest.mark.parametrize(
    ("angles", "ahead", "behind"),
    [
        ((), 0.0, 0.0),
        ((0.8,), 0.8, 2 * math.pi - 0.8),
        ((-0.5, 2.0, 3.0), 2.0, 0.5),
        ((-2.0, -3.0), 2 * math.pi - 3.0, 2.0),
    ],
)
def test_gaps_to_the_next_leaders_along_the_ring(angles, ahead, behind):
    names = [entry.name for entry in observation_entries({"fellow_leaders": 3})]
    found = features(fellows(*angles), names, FURTHER_FEATURES[-5:])
    expected = [math.cos(ahead), math.sin(ahead), math.cos(behind), math.sin(behind)]
    assert found == pytest.approx([len(angles), *expected], abs=1e-6)
    law = LeaningLaw(GAINS, 0.0, {"gap_ahead_sin": 0.3}, observation={"fellow_leaders": 3})
    rudder = 0.5 * 1.2 * math.tanh(0.3 * math.sin(ahead) / 1.2)
    assert law.predict(fellows(*angles))[0] == pytest.approx(rudder, abs=1e-6)


@pytest.mark.parametrize("unit_count", [0, 3])
def test_a_file_keeps_further_features_and_hidden_units(tmp_path, unit_count):
    random = np.random.default_rng(2)
    every = (*FEATURES, *FURTHER_FEATURES)
    weights = dict(zip(every, random.normal(0, 0.1, len(every)), strict=True))
    hidden = None
    if unit_count:
        inner = dict(zip(every, random.normal(0, 0.3, (len(every), unit_count)), strict=True))
        hidden = HiddenUnits(inner, random.normal(size=unit_count), random.normal(size=unit_count))
    law = LeaningLaw(GAINS, 0.1, weights, hidden=hidden, observation={"fellow_leaders": 2})
    law.save(tmp_path / "law.npz")
    again = load(tmp_path / "law.npz")
    env = flockenv.LeadersVectorEnv(
        4, n_leaders=3, mirror_to_target=True, target="random", observation={"fellow_leaders": 2}
    )
    rows, _ = env.reset(seed=1)
    np.testing.assert_array_equal(law.predict(rows)[0], again.predict(rows)[0])
    assert np.ptp(law.predict(rows)[0]) > 0
    assert again.features == every
    assert again.digest == law.digest
    with np.load(tmp_path / "law.npz") as file:
        kind = json.loads(str(file["header"]))["kind"]
    assert kind == ("nonlinear leaning law" if unit_count else "leaning law")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (({"near": [1.0]}, [0.0, 1.0], [1.0, 1.0]), "near of hidden units with shape"),
        (({"near": [1.0]}, [0.0], [1.0, 1.0]), "outputs of hidden units with shape"),
        (({}, [], []), "biases of hidden units with shape"),
        (({"near": "many"}, [0.0], [1.0]), "near of hidden units = 'many' is not accepted: numb"),
        (({}, [[0.0], [1.0, 2.0]], [1.0]), "biases of hidden units = .* is not accepted: numbers"),
        (({}, [0.0], [1j]), "outputs of hidden units = .* is not accepted: numbers"),
        (({"neer": [1.0]}, [0.0], [1.0]), "did you mean 'near'"),
        (({"near": [math.nan]}, [0.0], [1.0]), "not finite"),
    ],
)
def test_bad_hidden_units(arguments, message):
    with pytest.raises(flockenv.ParameterError, match=message):
        HiddenUnits(*arguments)


@pytest.mark.parametrize(
    ("feature", "blocks", "block"),
    [("fellows", {}, "fellow_leaders"), ("bw_duration", {"phase": False}, "phase")],
)
def test_a_feature_needs_its_block(feature, blocks, block):
    with pytest.raises(flockenv.ParameterError, match=f"switch the block {block} on"):
        LeaningLaw(GAINS, 0.0, {feature: 0.1}, observation=blocks)
    hidden = HiddenUnits({feature: [0.1]}, [0.0], [1.0])
    with pytest.raises(flockenv.ParameterError, match=f"switch the block {block} on"):
        LeaningLaw(GAINS, 0.0, {}, hidden=hidden, observation=blocks)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"hidden_weights": np.zeros((3, 2))}, "hidden_weights has shape"),
        ({"hidden_outputs": np.zeros(3)}, "hidden_outputs has shape"),
        ({"hidden_biases": np.zeros(())}, "hidden_weights has shape"),
        ({"hidden_outputs": None}, "the array hidden_outputs is missing"),
    ],
)
def test_damaged_hidden_units(tmp_path, change, message):
    hidden = HiddenUnits({"near": [0.3, 0.1]}, [0.0, 0.1], [1.0, -1.0])
    LeaningLaw(GAINS, 0.1, {}, hidden=hidden).save(tmp_path / "law.npz")
    arrays = {**read_arrays(tmp_path / "law.npz"), **change}
    kept_arrays = {name: array for name, array in arrays.items() if array is not None}
    write_arrays(tmp_path / "changed.npz", kept_arrays)
    with pytest.raises(flockenv.ParameterError, match=message):
        load(tmp_path / "changed.npz")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (({"gain": 1.0}, 0.0, {}), "gain, backward_gain, damping"),
        (({**GAINS, "gaim": 1.0}, 0.0, {}), "'gaim' is not accepted"),
        ((GAINS, math.nan, {}), "bias = nan"),
        ((GAINS, 0.0, {"near_wall": 1.0}), "'near_wall' is not accepted"),
        ((GAINS, 0.0, {"near": math.inf}), "near = inf"),
    ],
)
def test_bad_numbers(arguments, message):
    with pytest.raises(flockenv.ParameterError, match=message):
        LeaningLaw(*arguments)


@pytest.mark.parametrize("blocks", [{"own": False}, {"neighbors": 0}, {"order": False}])
def test_layouts_that_lack_what_it_looks_at(blocks):
    with pytest.raises(flockenv.ParameterError, match="own, neighbors and order"):
        LeaningLaw(GAINS, 0.0, {}, observation=blocks)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"features": ["near"]}, r"weights has shape .* is not accepted: \(1,\)"),
        ({"features": None}, "features = None is not accepted: a list of names"),
        ({"features": ["far", *FEATURES[1:]]}, "'far' is not accepted"),
        ({"features": [[], *FEATURES[1:]]}, "a list of names"),
        ({"kind": "pickle"}, "kind = 'pickle' is not accepted: one of network, leaning law"),
        ({"kind": ["leaning law"]}, "kind = "),
        ({"made": 3}, "made = 3 is not accepted"),
        ({"observation": {"order": False}}, "own, neighbors and order"),
        ({"observation_version": "1"}, "observation_version = '1' is not accepted"),
        ({"gains": np.full(3, np.nan)}, "gain = nan"),
        ({"gains": np.full(3, 1e300)}, "gain"),
        ({"gains": np.ones(2)}, r"gains has shape \(2,\), which is not accepted: \(3,\)"),
        ({"bias": np.zeros(2)}, "bias has shape"),
        ({"bias": np.array("0.1")}, "bias holds <U3"),
        ({"weights": None}, "the array weights is missing"),
    ],
)
def test_damaged_files(tmp_path, change, message):
    LeaningLaw(GAINS, 0.1, {"near": 0.2}).save(tmp_path / "law.npz")
    arrays = read_arrays(tmp_path / "law.npz")
    header = json.loads(str(arrays["header"]))
    for name, value in change.items():
        (arrays if name in arrays else header)[name] = value
    arrays = {name: array for name, array in arrays.items() if array is not None}
    write_arrays(tmp_path / "changed.npz", {**arrays, "header": np.array(json.dumps(header))})
    with pytest.raises(flockenv.ParameterError, match=message) as raised:
        load(tmp_path / "changed.npz")
    assert str(raised.value).startswith(f"{tmp_path / 'changed.npz'} is no whole policy: ")
