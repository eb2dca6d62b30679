"""A comparison runs every policy on the same seeds, through the environment a learner would use."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.comparison import NO_LEADERS, Case, compare_leaders, run_episodes
from flockenv.comparison.suite import tasks_named
from flockenv.policies import load

LAW = {"paper's law": "paper's law"}


@pytest.fixture(scope="module")
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(n_boats=9, pool="narrow")


def test_one_row_for_each_policy_number_and_seed(parameters: flockenv.FlockParameters) -> None:
    seconds = []
    runs = compare_leaders(parameters, [0, 1, 2], LAW, [5, 6], 40.0, seconds.append)
    assert runs["leaders"].tolist() == [0, 0, 1, 1, 2, 2]
    assert runs["seed"].tolist() == [5, 6] * 3
    assert runs["policy"].unique().tolist() == [NO_LEADERS, "paper's law"]
    assert runs["psi_o"].between(0, 1).all()
    assert (runs["signed_order"].abs() <= runs["psi_o"] + 1e-12).all()
    assert sum(seconds) == pytest.approx(6 * 40.0)


def test_results_belong_to_the_seed(parameters: flockenv.FlockParameters) -> None:
    alone = compare_leaders(parameters, [0, 1], LAW, [6], 40.0)
    among = compare_leaders(parameters, [0, 1], LAW, [5, 6, 7], 40.0)
    among = among[among["seed"] == 6].reset_index(drop=True)
    assert alone.equals(among)


@pytest.mark.parametrize(
    ("leaders", "policies"), [(0, {}), (2, {"every": "paper's law at every substep"})]
)
def test_runs_outside_the_environment_are_those_of_simulate(
    parameters: flockenv.FlockParameters, leaders: int, policies: dict[str, Any]
) -> None:
    runs = compare_leaders(parameters, [leaders], policies, [3], 60.0)
    env = flockenv.LeadersVectorEnv(1, params=parameters.replace(n_leaders=max(1, leaders)))
    _, infos = env.reset(seed=[3])
    led, seed = parameters.replace(n_leaders=leaders), int(infos["flock_seed"][0])
    recording = flockenv.simulate(led, seed, 60.0)
    late = recording.in_analysis_window & (recording.time_s > 6.0)
    assert runs["psi_o"].item() == pytest.approx(recording.order.psi_o[late].mean(), abs=1e-6)
    towards = np.cos(recording.order.phi_o - np.pi / 2) * recording.order.psi_o
    assert runs["signed_order"].item() == pytest.approx(towards[late].mean(), abs=1e-6)


def test_flocks_that_nobody_steers_in_steps_have_the_targets_of_the_others(parameters) -> None:
    """A target that alternates is that of the order, with and without leaders; so is a noise."""
    changes = {"target": "alternate", "bw_s": (0.1, 0.9)}
    laws = {"every": "paper's law at every substep", "law": "paper's law"}
    runs = compare_leaders(parameters, [0, 2], laws, range(3), 240.0, environment=changes)
    orders = {name: own["signed_order"].to_numpy() for name, own in runs.groupby("policy")}
    assert np.abs(orders["every"] - orders["law"]).max() < 0.5, "much the same law"
    fixed = compare_leaders(parameters, [0], {}, range(3), 240.0)["signed_order"].to_numpy()
    assert np.abs(fixed - orders[NO_LEADERS]).max() > 0.01
    law = run_episodes(parameters.replace(n_leaders=2), None, [1], 60.0, options={"target": "ccw"})
    ccw = parameters.replace(n_leaders=2, target="ccw")
    assert law == run_episodes(ccw, None, [1], 60.0)


def test_a_camera_that_misses_boats_is_that_of_each_leader(parameters) -> None:
    """Policies given leader by leader see what they see as one for all."""
    law = load("learned", pool="wide")
    wide = parameters.replace(n_leaders=2, pool="wide")
    for options in ({"dropout_rate": 0.3, "target": "alternate"}, {"control_hz": 5.0}):
        both = {"leader_0": law, "leader_1": law}
        one, each = (run_episodes(wide, it, [1, 2], 60.0, options=options) for it in (law, both))
        assert each["signed_order"] == pytest.approx(one["signed_order"], abs=1e-9)
        clear = run_episodes(wide, law, [1, 2], 60.0)["signed_order"]
        assert (one["signed_order"] != clear).all()


def test_each_of_several_policies_decides_at_its_own_rate(parameters) -> None:
    """Without control_hz a slow leader's rudder is held, as in a simulation."""

    class Counted:
        def __init__(self, control_hz: float) -> None:
            self.control_hz, self.decisions = control_hz, 0

        def predict(self, observation, state=None):
            self.decisions += 1
            return np.zeros(len(observation)), state

    led = parameters.replace(n_leaders=2)
    for options, expected in (({}, [5, 50]), ({"control_hz": 2.0}, [10, 10])):
        policies = {"leader_0": Counted(1.0), "leader_1": Counted(10.0)}
        run_episodes(led, policies, [1, 2], 5.0, options=options)
        assert [policy.decisions for policy in policies.values()] == expected


def test_targets_are_dealt_out_to_the_seeds(parameters: flockenv.FlockParameters) -> None:
    """A flock that goes around clockwise has the opposite order towards the other target."""
    led = parameters.replace(n_leaders=2)
    opposed = (("cw", "ccw"), ("ccw", "cw"))
    straight = {"straight ahead": "straight ahead"}
    orders = []
    for targets in (opposed, opposed[::-1]):
        case = Case(
            name="a", parameters=led, leaders=(2,), seeds=[3, 4], episode_s=40.0, targets=targets
        )
        orders.append(case.run(straight).set_index("seed")["signed_order"].sort_index())
    # Leaders that never steer move the same, whatever they are told.
    pd.testing.assert_series_equal(orders[0], -orders[1])


def test_flocks_count_once(parameters: flockenv.FlockParameters) -> None:
    law = {"law": "paper's law"}
    once = compare_leaders(parameters, [1], law, [1, 2], 5.0)
    pd.testing.assert_frame_equal(compare_leaders(parameters, [1, 1], law, [1, 2], 5.0), once)


def test_noises_may_be_drawn_from_a_range(parameters: flockenv.FlockParameters) -> None:
    drawn = compare_leaders(
        parameters, [1], {"law": "paper's law"}, [1, 2], 5.0, environment={"bw_s": (0.1, 0.9)}
    )
    assert len(drawn) == 2


class Shrinks:
    """Actions of another shape in the middle of an episode."""

    def predict(self, observation, state=None):
        calls = (state or 0) + 1
        return np.zeros(len(observation) if calls < 20 else 1), calls


def test_actions_of_another_shape_are_named(parameters) -> None:
    seconds: list[float] = []
    with pytest.raises(flockenv.ParameterError, match=r"has shape \(1,\), expected a rudder for"):
        compare_leaders(parameters, [1], {"mine": Shrinks()}, [1, 2], 5.0, seconds.append)
    assert len(seconds) == 19


def test_what_is_measured_in_steps_is_what_the_recording_says() -> None:
    # A flock that orders: low noise, four leaders.
    parameters = flockenv.FlockParameters(n_boats=12, n_leaders=4, pool="wide", bw_s=0.0)
    law = flockenv.policies.SteeringLaw()
    runs = compare_leaders(parameters, [4], {"law": lambda: law}, range(4), 240.0)
    env = flockenv.LeadersVectorEnv(4, params=parameters)
    _, infos = env.reset(seed=[0, 1, 2, 3])
    for row, seed in zip(runs.itertuples(), infos["flock_seed"], strict=True):
        recording = flockenv.simulate(parameters, int(seed), 240.0, policy=law)
        late = recording.in_analysis_window & (recording.time_s > 24.0)
        towards = recording.order.signed_order("cw")[late]
        assert row.signed_order == pytest.approx(towards.mean(), abs=1e-9)
        assert row.share_towards_target == pytest.approx((towards > 0.5).mean(), abs=1e-9)
        for within, found in ((20, row.ordering_time_s), (4, row.ordering_time_wide_s)):
            expected = recording.order.ordering_time(recording.time_s, np.pi / within)
            assert found == pytest.approx(expected)
    assert np.isfinite(runs["ordering_time_wide_s"]).any()
    assert not runs["ordering_time_wide_s"].isna().any()


def test_a_policy_for_each_leader(parameters: flockenv.FlockParameters) -> None:
    """Leaders of which each has the same law move as with that law; others do not."""
    both = {"leader_0": "damped law", "leader_1": "damped law"}
    policies = {"one": "damped law", "both": both, "pair": {**both, "leader_1": "straight ahead"}}
    runs = compare_leaders(parameters, [1, 2], policies, [1, 2], 30.0)
    orders = {name: own["signed_order"].tolist() for name, own in runs.groupby("policy")}
    assert orders["both"] == pytest.approx(orders["one"], abs=1e-9)
    assert orders["pair"][:2] == orders["both"][:2], "with one leader, the first policy steers"
    assert orders["pair"][2:] != orders["one"][2:]


def test_what_is_compared_may_be_gone_through_once(parameters: flockenv.FlockParameters) -> None:
    expected = compare_leaders(parameters, [0, 2], {"law": "paper's law"}, [1, 2], 5.0)
    for leaders, seeds in (
        ((k for k in (0, 2)), iter([1, 2])),
        (dict.fromkeys([0, 2]).keys(), {"a": 1, "b": 2}.values()),
        (np.array([0, 2]), range(1, 3)),
        (map(int, "02"), np.array([1, 2], np.uint64)),
        (range(0, 3, 2), filter(None, (0, 1, 2))),
    ):
        runs = compare_leaders(parameters, leaders, {"law": "paper's law"}, seeds, 5.0)
        pd.testing.assert_frame_equal(runs, expected, check_dtype=False)
    case = Case(
        name="one",
        parameters=parameters,
        leaders=iter([0, 2]),
        seeds=iter([1, 2]),
        episode_s=5.0,
        targets=(each for each in ["cw"]),
    )
    for _ in range(2):
        assert case.flock_hours(1) == 4 * 5.0 / 3600.0
        pd.testing.assert_frame_equal(case.run({"law": "paper's law"}).iloc[:, 1:], expected)
    assert [task.name for task in tasks_named("v2", iter(["camera"]))] == ["camera"]
