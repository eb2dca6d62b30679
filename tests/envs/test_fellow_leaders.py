"""Law: the block `fellow_leaders` is where the other leaders are along the ring, however far."""

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observe

ALONE = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
#: An observed 1.0 is six boat radii.
LENGTH = 30.0
#: Distance from the center, polar angle and LAP orientation (0 outward, growing clockwise).
LEADERS = [(140.0, 0.3, 1.2), (160.0, 0.9, 0.4), (120.0, -2.0, -2.2), (150.0, -0.5, 3.0)]
NORMAL = [(130.0, 0.6, 0.0), (150.0, 2.5, 1.0)]


def flock_of(leaders, sign=1.0, **fields):
    boats = [*leaders, *NORMAL]
    poses = [
        (radius * np.cos(angle), sign * radius * np.sin(angle), sign * (angle - orientation))
        for radius, angle, orientation in boats
    ]
    parameters = flockenv.FlockParameters(n_boats=len(boats), n_leaders=len(leaders), **fields)
    flock = flockenv.Flock(parameters, seed=0)
    flock.set_state(poses, np.zeros((len(boats), 3)))
    return flock


def rows(flock, count, **options):
    seen = observe(flock, {**ALONE, "fellow_leaders": count}, **options)
    return seen.reshape(len(seen), count, 6)


def test_the_nearest_come_first_at_any_distance_and_zeros_where_there_are_none():
    found = rows(flock_of(LEADERS), 4)[0]
    own_radius, own_angle, _ = LEADERS[0]
    # By center distance: the second leader, the fourth, and the third across the pool.
    for place, (radius, angle, orientation) in zip(
        found, (LEADERS[1], LEADERS[3], LEADERS[2]), strict=False
    ):
        clockwise = own_angle - angle
        expected = [
            1.0,
            np.cos(clockwise),
            np.sin(clockwise),
            (radius - own_radius) / LENGTH,
            np.cos(orientation),
            np.sin(orientation),
        ]
        assert place == pytest.approx(expected, abs=1e-5)
    assert not found[3].any()


def test_the_order_of_boats_and_normal_boats_do_not_matter():
    plain = rows(flock_of(LEADERS), 3)
    other = rows(flock_of([LEADERS[0], LEADERS[2], LEADERS[3], LEADERS[1]]), 3)
    assert other[[0, 3, 1, 2]] == pytest.approx(plain, abs=1e-6)
    few = rows(flock_of(LEADERS[:1]), 3)
    assert not few.any()
