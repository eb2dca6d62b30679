"""Law: flocks of a group have one state and one noise, and differ by what leads them alone."""

import numpy as np
import pytest

from flockenv import ParameterError
from flockenv.training.branching import BranchingFlocks

SMALL = {"branch_s": 8, "episode_s": 16, "seed": 0}


def held(*leans: float):
    """Return what leads each flock by a lean of its own."""
    return lambda seen: np.broadcast_to(np.array(leans)[:, None], seen.shape[:2])


def test_flocks_of_a_group_differ_by_their_leans_alone():
    flocks = BranchingFlocks("wide", groups=4, size=2, **SMALL)
    found = []
    for _ in range(4):  # Two branches of an episode, a start at rest in between.
        orders = flocks.branch(held(*[0.0] * 8))
        assert orders.shape == (8, 8)
        assert (orders[:, :4] == orders[:, 4:]).all()
        assert len({*orders[-1, :4]}) == 4
        found.append(orders[-1])
    assert (np.array(found)[1:] != np.array(found)[:-1]).all()
    orders = flocks.branch(held(*[0.0] * 4, *[1.0] * 4))
    assert (orders[-1, :4] != orders[-1, 4:]).all()


def test_groups_start_at_rest_in_turn():
    flocks = BranchingFlocks("wide", groups=4, size=2, **SMALL)
    had = []
    for _ in range(2):
        flocks.branch(held(*[0.0] * 8))
        had.append(flocks._branches_done.tolist())
    assert had == [[1, 2, 1, 2], [2, 1, 2, 1]]


@pytest.mark.parametrize(("groups", "episode_s"), [(1, 16), (2, 8)])
def test_all_groups_may_start_at_rest_at_once(groups, episode_s):
    flocks = BranchingFlocks("wide", groups=groups, size=2, **{**SMALL, "episode_s": episode_s})
    orders = [flocks.branch(held(*[0.0] * 2 * groups)) for _ in range(3)]
    assert np.isfinite(orders).all()
    assert (flocks._branches_done == 1).all()


def test_seeds_of_trainings_are_refused_beyond_their_range():
    with pytest.raises(ParameterError, match="seed = 4294967296"):
        BranchingFlocks("wide", groups=1, size=2, **{**SMALL, "seed": 1 << 32})
