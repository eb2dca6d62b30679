"""Law: lean features are affine in numbers of the mirrored view, the same for both targets.

On paper: a normal boat one unit (6 boat radii) ahead of a leader that heads the other way counts
with w = exp(-1/2), is opposed by 1, and turned by 0.
"""

import math

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries, observe
from flockenv.policies import DampedLaw
from flockenv.policies.laws import LEAN_FEATURES

ALONE = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
LEAN = {**ALONE, "lean_features": True}
NAMES = [entry.name for entry in observation_entries()]
OWN = ("radial_position", "outward_velocity", "clockwise_velocity", "forward_velocity")
ORDER = [f"mean_{name}" for name in ("cos_orientation", "sin_orientation")]
ORDER += [f"mean_{name}" for name in ("outward_velocity", "clockwise_velocity")]


def expected(row: np.ndarray) -> list[float]:
    """The features of a mirrored observation of the default layout, not standardized."""
    seen = {name: float(row[place]) for place, name in reversed(list(enumerate(NAMES)))}
    order = [float(number) for number in row[-4:]]
    near, leaders = np.zeros(11), np.zeros(3)
    for there, x, y, cos, sin, vx, vy, leads in row[15:63].reshape(6, 8).astype(float):
        square, opposed = x**2 + y**2, (1 - cos) / 2
        terms = [1, x, y, opposed, sin, vx, vy, opposed * x, opposed * y, sin * x, sin * y]
        near += there * (1 - leads) * math.exp(-square / 2) * np.array(terms)
        leaders += there * leads * math.exp(-square / 8) * np.array([1, x, y])
    outer = max(0.0, seen["radial_position"] - 0.6)
    further = ("cos_orientation", "sin_orientation", "clockwise_spin", "fw", "bw", "bw_duration")
    own, rest = [seen[name] for name in OWN], [seen[name] for name in further]
    return [*own, outer, *order, *near, *leaders, *rest]


CROWD = {"n_boats": 27, "n_leaders": 3, "mirror_to_target": True}


@pytest.mark.parametrize("pool", ["wide", "narrow"])
def test_features_are_affine_in_what_is_seen(pool):
    task = {"observation": {"lean_features": True}, "bw_s": (0.2, 0.6), "target": "random"}
    env, rows = flockenv.LeadersVectorEnv(8, pool=pool, **CROWD, **task), []
    law = DampedLaw(mirror_to_target=True, observation={"lean_features": True})
    seen, _ = env.reset(seed=1)
    for step in range(300):
        seen, *_ = env.step(law.predict(seen)[0])
        if step % 10 == 0:
            rows.append(seen.reshape(24, -1))
    rows = np.concatenate(rows)
    size = len(NAMES)
    assert rows.shape[1] == size + len(LEAN_FEATURES)
    raw = np.array([expected(row[:size]) for row in rows])
    for place, name in enumerate(LEAN_FEATURES):
        found = rows[:, size + place].astype(float)
        slope, start = np.polyfit(raw[:, place], found, 1)
        within = np.abs(found) < 20
        assert slope > 0, name
        assert np.abs(found - start - slope * raw[:, place])[within].max() < 2e-6 * slope + 1e-6, (
            name
        )


@pytest.mark.parametrize("pool", ["wide", "narrow"])
def test_they_are_standardized_under_the_tuned_law(pool):
    bw_s = flockenv.FlockParameters.critical_bw_s("simulation", pool)
    leaning = {"action_mode": "lean", "observation": LEAN}
    env = flockenv.LeadersVectorEnv(64, pool=pool, bw_s=bw_s, **CROWD, **leaning)
    env.reset(seed=7)
    rows = []
    for step in range(2600):
        seen, *_ = env.step(np.zeros((64, 3)))
        if step > 200 and step % 20 == 0:
            rows.append(seen.reshape(192, -1))
    rows = np.concatenate(rows)
    varies = [place for place, name in enumerate(LEAN_FEATURES) if name != "bw_duration"]
    assert np.abs(rows.mean(axis=0)).max() < 0.3
    deviation = rows[:, varies].std(axis=0)
    assert 0.6 < deviation.min() < deviation.max() < 1.6


def pair(target: str, sign: float) -> np.ndarray:
    """Lean features of a leader on the tangent that meets a normal boat one unit ahead."""
    params = flockenv.FlockParameters(n_boats=3, n_leaders=1, pool="wide", target=target)
    flock = flockenv.Flock(params, 0)
    # At (140, 0) outward is +x and clockwise -y.
    pose = [[140.0, 0.0, -sign * np.pi / 2], [140.0, -30.0 * sign, sign * np.pi / 2]]
    flock.set_state([*pose, [-140.0, 0.0, 0.0]], np.zeros((3, 3)))
    return observe(flock, LEAN)[0].astype(float)


def test_a_normal_boat_ahead_on_paper():
    found = dict(zip(LEAN_FEATURES, pair("cw", 1.0), strict=True))
    # The deviations cancel in ratios to a flock without anybody near: what is seen, over w.
    alone = flockenv.Flock(flockenv.FlockParameters(n_boats=2, n_leaders=1, pool="wide"), 0)
    alone.set_state([[140.0, 0.0, -np.pi / 2], [-140.0, 0.0, 0.0]], np.zeros((2, 3)))
    none = dict(zip(LEAN_FEATURES, observe(alone, LEAN)[0].astype(float), strict=True))
    assert found["near_turned"] == pytest.approx(none["near_turned"], abs=1e-6)
    assert found["near_outward"] == pytest.approx(none["near_outward"], abs=1e-6)
    assert found["leaders"] == none["leaders"]
    for name in ("near", "near_ahead", "near_opposed", "opposed_ahead"):
        assert found[name] > none[name] + 0.3, name


def test_they_are_mirrored_to_the_target():
    np.testing.assert_allclose(pair("ccw", -1.0), pair("cw", 1.0), atol=1e-6)


@pytest.mark.parametrize("pool", [(100.0, 40.0), (90.0, 20.0)])
def test_other_pools_are_refused(pool):
    with pytest.raises(flockenv.ParameterError, match="only in the pools wide and narrow"):
        flockenv.LeadersEnv(pool=pool, observation=LEAN)
