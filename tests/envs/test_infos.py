"""Law: infos hold no NaN. What never came is infinite, what has no mean is left out."""

import json
import math

import numpy as np
import pytest

import flockenv
from flockenv import order
from flockenv.envs.batch import mean_rows

SMALL = {"n_boats": 6, "n_leaders": 2}
QUANTITIES = [
    each.name
    for each in order.QUANTITIES
    if each.is_averaged and each.kind in ("recorded", "derived")
]
RECORDED = order.ORDER
WINDOW_MEANS = {*QUANTITIES, "share_towards_target"}


def numbers(value):
    if isinstance(value, dict):
        return [number for each in value.values() for number in numbers(each)]
    if isinstance(value, list | tuple):
        return [number for each in value for number in numbers(each)]
    array = np.asarray(value)
    if array.dtype == object:
        return [number for each in array.tolist() if each is not None for number in numbers(each)]
    return array.ravel().tolist() if array.dtype.kind in "fiub" else []


def last_info(**options):
    env = flockenv.LeadersEnv(**{**SMALL, **options})
    env.reset(seed=0)
    over = False
    while not over:
        _, _, _, over, info = env.step(np.zeros(2))
        assert not any(map(math.isnan, numbers(info)))
    return info


def test_a_time_that_never_came_is_infinite():
    summary = last_info(episode_s=8.0)["episode_summary"]
    assert summary["ordering_time_s"] == summary["ordering_time_wide_s"] == math.inf
    assert summary.keys() >= WINDOW_MEANS


# A tenth of 15 s is in the window itself: the sample at that time does not count.
@pytest.mark.parametrize("episode_s", [8.0, 15.0, 20.0])
def test_means_are_those_of_the_normal_boats_in_the_window(episode_s):
    env = flockenv.LeadersEnv(episode_s=episode_s, target="cw", **SMALL)
    env.reset(seed=3)
    seen, over = [], False
    while not over:
        _, _, _, over, info = env.step(np.array([0.4, -0.1]))
        if env.flock.in_analysis_window and env.flock.time_s > 0.1 * episode_s + 1e-9:
            seen.append(env.flock.order_parameters())
    series = flockenv.OrderSeries(
        **{name: np.array([getattr(each, name) for each in seen]) for name in RECORDED}
    )
    assert len(seen) > 10
    for name in QUANTITIES:
        mean = info["episode_summary"][name]
        assert mean == pytest.approx(series.series(name, "cw").mean(), rel=1e-12), name


def test_means_over_a_window_that_was_not_reached_are_left_out():
    # The first forward phase, 2 s, starts at rest: its analysis window starts after 1 s, the one
    # after it at 2.5 s.
    summary = last_info(episode_s=0.5)["episode_summary"]
    assert not WINDOW_MEANS & summary.keys()
    assert {"ordering_time_s", "total_reward", "reward_terms"} <= summary.keys()


def test_agents_are_told_of_a_reset_what_one_policy_is():
    options = {"n_boats": 9, "n_leaders": 2, "target": "random", "bw_s": (0.2, 0.4)}
    _, info = flockenv.LeadersEnv(**options).reset(seed=4)
    _, each = flockenv.parallel_env(**options).reset(seed=4)
    assert info.keys() == {"target", "bw_s", "flock_seed"}
    assert each == {"leader_0": info, "leader_1": info}
    assert each["leader_0"] is not each["leader_1"]


@pytest.mark.parametrize("seed", [0, 2**63, 2**64 - 1])
def test_infos_are_plain_and_seeds_are_whole(seed):
    """JSON takes the infos of one flock; the arrays of many hold seeds up to the last one."""
    options = {"n_boats": 9, "n_leaders": 2, "episode_s": 6.0, "bw_s": (0.2, 0.4)}
    env, each = flockenv.LeadersEnv(**options), flockenv.parallel_env(**options)
    for made, still in ((env, np.zeros(2)), (each, {key: [0.0] for key in each.possible_agents})):
        _, info = made.reset(seed=seed)
        infos = [info, *(made.step(still)[-1] for _ in range(60))]
        again = json.loads(json.dumps(infos))
        assert again == infos
        first, last = (
            (again[0], again[-1]) if made is env else (again[0]["leader_0"], again[-1]["leader_1"])
        )
        assert first["flock_seed"] == last["episode_summary"]["flock_seed"] == seed
    many = flockenv.LeadersVectorEnv(1, **options)
    _, infos = many.reset(seed=seed)
    assert infos["flock_seed"].tolist() == [seed]
    for _ in range(60):
        infos = many.step(np.zeros((1, 2)))[-1]
    assert infos["episode_summary"]["flock_seed"].tolist() == [seed]


@pytest.mark.parametrize("leaders", [1, 2, 3, 7, 8, 9, 20])
def test_means_over_leaders_have_the_bits_of_numpy(leaders):
    random = np.random.default_rng(leaders)
    for _ in range(50):
        rows = random.normal(size=(leaders, 8)) * 10.0 ** random.integers(-9, 9, (leaders, 8))
        rows[random.uniform(size=rows.shape) < 0.2] = -0.0
        expected = np.array([each.mean() for each in rows.T])
        assert np.array(mean_rows(rows.tolist())).tobytes() == expected.tobytes()


def test_actions_of_every_kind_have_the_same_bits():
    """What the action spaces give is not checked as other kinds of numbers are."""
    options = {"n_boats": 8, "n_leaders": 2, "episode_s": 2.0}
    plain = np.array([0.3, -1.7], np.float32)
    kinds = [plain, plain.astype(np.float64), plain.tolist(), plain[::-1].copy()[::-1]]
    seen = []
    for each in kinds:
        env, agents = flockenv.LeadersEnv(**options), flockenv.parallel_env(**options)
        env.reset(seed=1)
        agents.reset(seed=1)
        for _ in range(5):
            step = env.step(each)
            by_agent = agents.step({"leader_1": [each[1]], "leader_0": np.array([each[0]])})
        assert step[1] == pytest.approx(np.mean([*by_agent[1].values()]))
        infos = [by_agent[4][agent]["reward_terms"] for agent in agents.agents]
        for name, mean in step[4]["reward_terms"].items():
            assert mean == np.mean([info[name] for info in infos])
            assert type(mean) is float
        seen.append((env.get_state(), agents.get_state()))
    assert seen == [seen[0]] * len(kinds)
    assert {*seen[0]} == {seen[0][0]}
