"""Law: flocks of one snapshot meet the same noise, and other noise by a noise_seed."""

import copy
import pickle

import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters, ParameterError, simulate

PARAMETERS = FlockParameters(n_boats=8, n_leaders=2, pool="narrow", bw_s=0.4)
#: One boat in open water: its heading is its noise alone, whatever its rudder is while it stands.
ALONE = FlockParameters(
    n_boats=1, n_leaders=0, pool=(np.inf, 0.0), fw_s=0.0, bw_s=0.0, nop1_s=1.0, nop2_s=0.0
)


def snapshot(parameters=PARAMETERS, seed=7, seconds=3.0):
    flock = Flock(parameters, seed)
    flock.advance(seconds)
    return flock.snapshot()


BLOB = snapshot()


def after(noise_seed, blob=BLOB, seconds=4.0):
    flock = Flock.from_snapshot(blob, noise_seed)
    flock.advance(seconds)
    return flock


def test_without_a_noise_seed_the_noise_is_that_of_the_snapshot():
    went_on = Flock(PARAMETERS, 7)
    went_on.advance(3.0)
    went_on.advance(4.0)
    assert after(None).snapshot() == went_on.snapshot()
    assert (went_on.noise_seed, after(5).noise_seed) == (None, 5)


def test_a_noise_seed_changes_the_noise_and_nothing_else():
    flock = Flock(PARAMETERS, 1)
    flock.restore(BLOB, noise_seed=5)
    assert (flock.pose == Flock.from_snapshot(BLOB).pose).all()
    assert (flock.seed, flock.time_s) == (7, 3.0)
    flock.advance(4.0)
    assert flock.snapshot() == after(5).snapshot()
    ends = [after(noise_seed).pose for noise_seed in (None, 5, 6)]
    assert len({end.tobytes() for end in ends}) == 3


def test_a_branch_of_a_branch_has_the_noise_that_it_is_given():
    blob = after(5, seconds=0.0).snapshot()
    assert after(6, blob).snapshot() == after(6).snapshot()
    assert after(None, blob).snapshot() == after(5).snapshot()


def test_the_noise_is_never_that_of_a_flock_with_this_seed():
    """A planner that counts its branches from 0 must not meet the future that it plans for."""
    assert not np.array_equal(after(7).pose, after(None).pose)


@pytest.mark.parametrize("noise_scheme", ["white", "per-step"])
def test_two_flocks_meet_the_same_noise(noise_scheme):
    """The change of a resting boat's spin over one short substep is its noise to rounding."""
    still = ALONE.replace(noise_scheme=noise_scheme, c1=0.0, c3=0.0)
    turns = []
    for seed, noise_seed in [(1, 5), (2, 5), (2, 6), (5, None)]:
        flock = Flock.from_snapshot(snapshot(still, seed, 1.0), noise_seed)
        before = flock.velocity[0, 2]
        flock.advance(0.02)
        turns.append(flock.velocity[0, 2] - before)
    assert turns[0] == pytest.approx(turns[1], rel=1e-9)
    assert abs(turns[1] - turns[2]) > 1e-6
    assert abs(turns[1] - turns[3]) > 1e-6


def test_a_branch_stays_one_through_snapshots_copies_pickles_and_changes():
    branch = Flock.from_snapshot(BLOB, 5)
    branch.advance(2.0)
    again = Flock(PARAMETERS, 3)
    again.restore(branch.snapshot())
    copies = [again, copy.copy(branch), pickle.loads(pickle.dumps(branch))]
    branch.advance(2.0)
    for each in copies:
        assert each.noise_seed == 5
        each.advance(2.0)
        assert each.snapshot() == branch.snapshot()
    again.reset(4)
    assert again.noise_seed is None
    assert again.snapshot() == Flock(PARAMETERS, 4).snapshot()
    # New parameters make the streams anew.
    changed = {"start": BLOB, "schedule": [(0.0, {"bw_s": 0.6})]}
    own, other = (simulate(PARAMETERS, 7, 2.0, noise_seed=each, **changed) for each in (None, 5))
    assert not np.array_equal(own.pose[-1], other.pose[-1])


def test_simulate_continues_with_other_noise():
    for noise_seed in (None, 5):
        run = simulate(PARAMETERS, 7, 4.0, start=BLOB, noise_seed=noise_seed)
        assert (run.pose[-1] == after(noise_seed).pose).all()


REFUSED = [
    (-1, ParameterError),
    (2**64, ParameterError),
    (5.5, ParameterError),
    (float("nan"), ParameterError),
    (True, TypeError),
    (np.True_, TypeError),
    ("5", TypeError),
    ([5], TypeError),
]


@pytest.mark.parametrize(("noise_seed", "error"), REFUSED)
def test_what_is_no_noise_seed_is_refused_and_changes_nothing(noise_seed, error):
    flock = Flock(PARAMETERS, 1)
    before = flock.snapshot()
    for attempt in (
        lambda: flock.restore(BLOB, noise_seed),
        lambda: Flock.from_snapshot(BLOB, noise_seed),
        lambda: simulate(PARAMETERS, 7, 1.0, start=BLOB, noise_seed=noise_seed),
    ):
        with pytest.raises(error, match="noise_seed"):
            attempt()
    assert flock.snapshot() == before


@pytest.mark.parametrize("noise_seed", [np.int64(5), np.uint64(5), np.array(5)])
def test_whole_numbers_of_any_kind_are_seeds(noise_seed):
    assert after(noise_seed).snapshot() == after(5).snapshot()


def test_a_noise_seed_goes_with_a_snapshot():
    state = {"pose": Flock(PARAMETERS, 7).pose}
    recording = simulate(PARAMETERS, 7, 1.0)
    for start in (None, state, recording):
        with pytest.raises(ParameterError, match="noise_seed = 5"):
            flockenv.simulate(PARAMETERS, 7, 1.0, start=start, noise_seed=5)
