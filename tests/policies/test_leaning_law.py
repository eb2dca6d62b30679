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
from flockenv.policies import DampedLaw, LeaningLaw, load
from flockenv.policies.leaning_law import FEATURES

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
        4, n_boats=27, n_leaders=3, pool="table-1", bw_s=0.5, mirror_to_target=True, target="random"
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
