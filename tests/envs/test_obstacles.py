"""Law: the block `obstacles` is where the nearest points of discs and walls are, in LAP axes."""

import math

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries, observe
from flockenv.policies import NetworkPolicy

ALONE = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
#: An observed 1.0 is six boat radii.
LENGTH = 30.0
ARENA = {
    "pool": (200.0, 0.0),
    "discs": [(140.0, 0.0, 10.0), (-100.0, 0.0, 20.0)],
    "walls": [(100.0, -30.0, 180.0, -30.0)],
}


def flock_at(*pose, **fields):
    parameters = flockenv.FlockParameters(n_boats=1, n_leaders=1, **{**ARENA, **fields})
    flock = flockenv.Flock(parameters, seed=0)
    flock.set_state([pose], np.zeros((1, 3)))
    return flock


def rows(flock, count, **options):
    row = observe(flock, {**ALONE, "obstacles": count}, **options)[0]
    return row.reshape(count, 4) * [1.0, LENGTH, LENGTH, LENGTH]


def test_nearest_first_and_zeros_where_there_are_none():
    # At (100, 0) outward is x and clockwise is -y. The wall's end is 30 cm clockwise, the disc's
    # surface 30 cm outward; the boat heads outward, so that its bow is 2.5 + 5 cm nearer to it.
    found = rows(flock_at(100.5, 0.0, 0.0), 4)
    assert found[0] == pytest.approx([1, 29.5, 0, 29.5 - 7.5], abs=1e-4)
    assert found[1] == pytest.approx([1, 0, 30, 30 - 5], abs=1e-4)
    assert found[2] == pytest.approx([1, -120, 0, 120], abs=1e-4)  # clipped at four lengths
    assert not found[3].any()


def test_the_wall_s_end_is_its_nearest_point_beyond_it():
    found = rows(flock_at(91.0, -18.0, 0.0, discs=()), 1)[0]
    outward = np.array([91.0, -18.0]) / math.hypot(91.0, 18.0)
    clockwise = np.array([outward[1], -outward[0]])
    to_end = np.array([9.0, -12.0])
    # From the core's bow end, 2.5 cm ahead of the center.
    gap = math.hypot(6.5, 12.0) - 5.0
    assert found == pytest.approx([1, to_end @ outward, to_end @ clockwise, gap], abs=1e-4)


def test_policies_observe_them(tmp_path):
    size = len(observation_entries({"obstacles": 2}))
    policy = NetworkPolicy([np.zeros((size, 1))], [[0.1]], observation={"obstacles": 2})
    policy.save(tmp_path / "policy.npz")
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=2, **ARENA)
    run = flockenv.simulate(parameters, 1, 2.0, policy=str(tmp_path / "policy.npz"))
    assert np.isfinite(run.pose).all()
