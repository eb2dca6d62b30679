"""Law: a run starts, changes, is steered and is measured as it is told."""

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters, ParameterError, Recording, simulate

PARAMETERS = FlockParameters(n_boats=10, n_leaders=2, pool="narrow")


class Held:
    """The same rudder at all times."""

    def __init__(self, rudder: float, decision_period_s: float = 0.1) -> None:
        self.rudder, self.decision_period_s = rudder, decision_period_s

    def predict(self, observation, state=None, episode_start=None):
        return np.full(len(observation), self.rudder), state


@pytest.mark.parametrize(
    ("schedule", "words"),
    [
        ([(1.0, {"n_boats": 11})], "n_boats does not change"),
        ([(1.0, {"bw": 1.0})], "'bw' is no field.*'bw_s'"),
        ([(1.0, {"bw_s": -1.0})], "bw_s"),
        ([(1.0, {"target": "left"})], "target"),
        ([(1.0, {"pool": (20.0, 15.0)})], "n_boats"),
        ([(-1.0, {"bw_s": 1.0})], "a time in s"),
        ([(float("nan"), {"bw_s": 1.0})], "a time in s"),
        ([{"bw_s": 1.0}], "a time in s"),
        ([(1.0, "ccw")], "a time in s"),
    ],
)
def test_schedules_that_cannot_be_are_refused(schedule, words):
    with pytest.raises(ParameterError, match=words):
        simulate(PARAMETERS, 3, 2.0, schedule=schedule)


def test_the_state_of_a_jam_is_a_start():
    jam = simulate(PARAMETERS.replace(n_boats=27, bw_s=0.0), 3, 30.0)
    state = jam.state_at(30.0)
    del state["allow_overlap"]
    run = simulate(jam.parameters, 3, 1.0, start=state)
    assert np.array_equal(run.pose[0], jam.pose[-1])
    # Two hulls of radius 5 cm side by side, 0.06 and 0.04 cm into each other.
    pair = PARAMETERS.replace(n_boats=2, n_leaders=0)
    for overlap_cm in (0.06, 0.04):
        pose = [[70.0, 0.0, 0.0], [70.0, 10.0 - overlap_cm, 0.0]]
        if overlap_cm < 0.05:
            assert simulate(pair, 3, 0.1, start={"pose": pose}).pose[0].tolist() == pose
        else:
            with pytest.raises(ParameterError, match=r"boats \d and \d overlap"):
                simulate(pair, 3, 0.1, start={"pose": pose})


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_run_goes_on_from_where_another_ended(dtype):
    first = simulate(PARAMETERS.replace(n_boats=27, bw_s=0.0), 3, 30.0, dtype=dtype)
    loop = simulate(first.parameters.replace(bw_s=0.5), 4, 5.0, start=first)
    assert loop.time_s[[0, -1]].tolist() == [30.0, 35.0]
    assert np.array_equal(loop.pose[0], first.pose[-1])
    assert np.array_equal(loop.velocity[0], first.velocity[-1])
    with pytest.raises(ParameterError, match="pose"):
        simulate(PARAMETERS.replace(n_boats=26), 4, 5.0, start=first)
    with pytest.raises(ParameterError, match="no poses"):
        simulate(first.parameters, 4, 5.0, start=first.without_poses())


def test_each_leader_has_a_policy_of_its_own():
    seats = {"leader_1": Held(-0.25), "leader_0": Held(0.5)}
    run = simulate(PARAMETERS, 3, 2.0, policy=seats)
    assert (run.rudder[1:] == [0.5, -0.25]).all()
    assert run.policy == "leader_0: Held; leader_1: Held"
    both = simulate(PARAMETERS, 3, 2.0, policy=dict.fromkeys(seats, "damped law"))
    assert np.array_equal(both.pose, simulate(PARAMETERS, 3, 2.0, policy="damped law").pose)
    mixed = simulate(
        PARAMETERS, 3, 2.0, policy={"leader_0": "paper's law", "leader_1": "straight ahead"}
    )
    law = simulate(PARAMETERS, 3, 2.0, policy=flockenv.policies.SteeringLaw())
    assert np.array_equal(mixed.rudder[1], [law.rudder[1, 0], 0.0])
    assert mixed.rudder[1, 0] != 0.0


def test_a_mirrored_policy_follows_a_target_that_changes():
    law = flockenv.policies.SteeringLaw
    change = [(1.0, {"target": "ccw"})]
    plain = simulate(PARAMETERS, 3, 3.0, policy=law(), schedule=change)
    mirrored = simulate(PARAMETERS, 3, 3.0, policy=law(mirror_to_target=True), schedule=change)
    assert np.abs(plain.rudder).max() > 0.5
    assert mirrored.rudder == pytest.approx(plain.rudder, abs=1e-4)


@pytest.mark.parametrize(
    ("policy", "words"),
    [
        ({"leader_0": "paper's law"}, "a policy for each of leader_0, leader_1"),
        ({"leader_0": "paper's law", "leader_1": "low"}, "'low' is no policy"),
        ({"leader_0": Held(0.0), "leader_1": Held(0.0, 0.5)}, "2, 10 times per second"),
        ({"leader_0": Held(0.0), "leader_1": 7}, "policy = 7"),
    ],
)
def test_policies_that_do_not_fit_the_leaders_are_refused(policy, words):
    with pytest.raises(ParameterError, match=words):
        simulate(PARAMETERS, 3, 2.0, policy=policy)


def spread_cm(run: Recording) -> np.ndarray:
    return run.pose[..., :2].std(axis=1).mean(axis=1)


def test_own_quantities_go_where_the_recording_goes(tmp_path):
    run = simulate(PARAMETERS, 3, 20.0, 2.0, quantities={"spread_cm": spread_cm})
    assert np.array_equal(run.quantities["spread_cm"], spread_cm(run))
    run.save(tmp_path / "run.npz")
    assert Recording.load(tmp_path / "run.npz") == run
    assert run != simulate(PARAMETERS, 3, 20.0, 2.0)
    late = run.analyzed()
    assert np.array_equal(late.quantities["spread_cm"], spread_cm(late))
    assert run.to_dataframe()["spread_cm"].tolist() == spread_cm(run).tolist()
    assert run.to_xarray()["spread_cm"].dims == ("time_s",)


@pytest.mark.parametrize(
    ("name", "function", "words"),
    [
        ("psi_o", spread_cm, "an identifier that no quantity"),
        ("time_s", spread_cm, "an identifier that no quantity"),
        ("my spread", spread_cm, "an identifier that no quantity"),
        ("mine", lambda run: spread_cm(run)[1:], r"shape \(20,\), expected \(21,\)"),
        ("mine", lambda run: 1.0, r"shape \(\), expected \(21,\)"),
        ("mine", lambda run: ["a"] * len(run), "'mine' is not accepted: numbers"),
    ],
)
def test_own_quantities_that_are_no_series_are_refused(name, function, words):
    with pytest.raises(ParameterError, match=words):
        simulate(PARAMETERS, 3, 2.0, quantities={name: function})
