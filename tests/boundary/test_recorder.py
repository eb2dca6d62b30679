"""Law: a recorded run is bit for bit that of a flock moved by hand, whatever changes on the way."""

import numpy as np
import pytest

import flockenv
from flockenv import Flock, simulate

PARAMETERS = flockenv.FlockParameters(n_boats=8, n_leaders=2, pool="narrow", bw_s=0.5)


def same(run: flockenv.Recording, place: int, flock: Flock) -> bool:
    return (
        run.time_s[place] == flock.time_s
        and run.phase[place] == flock.phase
        and np.array_equal(run.pose[place], flock.pose)
        and np.array_equal(run.velocity[place], flock.velocity)
        and run.order[place] == flock.order_parameters()
    )


def near(run: flockenv.Recording, place: int, flock: Flock) -> bool:
    return (
        run.time_s[place] == flock.time_s
        and run.phase[place] == flock.phase
        and np.allclose(run.pose[place], flock.pose, rtol=0.0, atol=1e-9)
        and np.allclose(run.velocity[place], flock.velocity, rtol=0.0, atol=1e-9)
    )


def changed(flock: Flock, pose, fields) -> Flock:
    moved = Flock(flock.parameters.replace(**fields), 4)
    moved.set_state(pose, flock.velocity, flock.time_s, allow_overlap=True)
    return moved


def advance_to(flock: Flock, time_s: float, rudder=None) -> None:
    flock.advance(max(time_s - flock.time_s, 0.0), rudder)


def test_targets_change_after_the_sample_at_their_time():
    changes = [(4.0, {"target": "cw"}), (2.0, {"target": "ccw"})]
    run = simulate(PARAMETERS, 3, 8.0, 5.0, schedule=changes)
    flock = Flock(PARAMETERS, 3)
    for place in range(41):
        advance_to(flock, place / 5)
        assert same(run, place, flock)
        if place in (10, 20):
            flock.set_target({10: "ccw", 20: "cw"}[place])
    assert run.order[-1] != simulate(PARAMETERS, 3, 8.0, 5.0).order[-1]


def test_parameters_change_after_the_sample_at_their_time():
    changes = {16: {"bw_s": 0.2}, 32: {"c4": 0.05}}
    run = simulate(PARAMETERS, 4, 8.0, 5.0, schedule=[(6.4, changes[32]), (3.2, changes[16])])
    flock = Flock(PARAMETERS, 4)
    for place in range(41):
        advance_to(flock, place / 5)
        assert same(run, place, flock)
        if place in changes:
            flock = changed(flock, flock.pose, changes[place])
    assert run.parameters == PARAMETERS


def test_boats_keep_their_share_of_the_way_between_the_walls():
    pool = {"pool": (120.0, 40.0)}
    run = simulate(PARAMETERS, 4, 8.0, 5.0, schedule=[(3.2, pool)])
    flock = Flock(PARAMETERS, 4)
    for place in range(41):
        advance_to(flock, place / 5)
        # NumPy and the core round the new positions alike, but for the last bit.
        assert same(run, place, flock) if place <= 16 else near(run, place, flock)
        if place == 16:
            pose = flock.pose
            distance = np.hypot(pose[:, 0], pose[:, 1])
            share = (distance - 48.5) / (90.0 - 48.5)
            pose[:, :2] *= ((40.0 + share * (120.0 - 40.0)) / distance)[:, None]
            flock = changed(flock, pose, pool)


class Watching:
    """Rudders from what is seen, and how often they were requested."""

    def __init__(self, mirror_to_target: bool = False) -> None:
        self.calls, self.mirror_to_target = 0, mirror_to_target

    def predict(self, observation, state=None, episode_start=None):
        self.calls += 1
        turns = 0 if state is None else state
        return 2.0 * np.sin(observation[:, :3].sum(axis=1) + turns), turns + 1


@pytest.mark.parametrize("control_hz", [10.0, 3.0])
@pytest.mark.parametrize("mirrored", [False, True])
def test_rudders_are_held_between_control_steps(control_hz, mirrored):
    parameters = PARAMETERS.replace(target="ccw")
    policy = Watching(mirrored)
    run = simulate(parameters, 3, 6.0, 5.0, policy, control_hz=control_hz)
    by_hand, flock, rudder = Watching(mirrored), Flock(parameters, 3), np.zeros(2)
    samples, steps = np.arange(31) / 5, np.arange(int(6 * control_hz) + 1) / control_hz
    state, place = None, 0
    for time_s in np.unique(np.round(np.concatenate([samples, steps]), 9)):
        advance_to(flock, time_s, rudder)
        if np.isclose(samples, time_s).any():
            assert same(run, place, flock)
            place += 1
        if np.isclose(steps, time_s).any():
            seen = flockenv.envs.observation.observe(
                flock, mirror_to_target=mirrored, rudder=rudder
            )
            actions, state = by_hand.predict(seen, state)
            rudder = np.clip(actions, -1.0, 1.0) * (-1.0 if mirrored else 1.0)
    assert (place, policy.calls) == (31, by_hand.calls)


@pytest.mark.parametrize("policy", [Watching(), "learned", "paper's law"])
def test_a_policy_without_leaders_is_refused(policy):
    unled = PARAMETERS.replace(n_leaders=0, pool="wide")
    with pytest.raises(flockenv.ParameterError, match="with n_leaders = 0 it steers nobody"):
        simulate(unled, 3, 2.0, policy=policy)
    assert simulate(unled, 3, 2.0, policy={}) == simulate(unled, 3, 2.0)


def test_progress_is_reported_with_and_without_a_policy():
    for how in ({}, {"policy": Watching(), "control_hz": 1.0}):
        reported = []
        simulate(PARAMETERS, 3, 1800.0, 1.0, progress=reported.append, **how)
        assert len(reported) > 2
        assert 1200.0 < sum(reported) <= 1800.0
        assert min(reported) > 0.0
