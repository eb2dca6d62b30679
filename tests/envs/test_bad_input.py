"""Law: bad input is a named error, and nothing has moved."""

import numpy as np
import pytest

import flockenv
from flockenv import EpisodeError, FlockError, ParameterError

OPTIONS = {"n_boats": 9, "n_leaders": 2, "episode_s": 1.0}
NOTHING = dict.fromkeys(["own", "phase", "target", "order", "neighbors"], 0)
INTERFACES = {
    "single": lambda **options: flockenv.LeadersEnv(**options),
    "parallel": lambda **options: flockenv.parallel_env(**options),
    "vector": lambda **options: flockenv.LeadersVectorEnv(3, **options),
}


@pytest.fixture(params=INTERFACES.values(), ids=INTERFACES.keys())
def interface(request):
    return lambda **options: request.param(**{**OPTIONS, **options})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"n_leader": 2}, "did you mean 'n_leaders'"),
        ({"episode": 3.0}, "did you mean 'episode_s'"),
        ({"rewards": {}}, "did you mean 'reward'"),
        ({"xyzzy": 1}, "there are preset, params"),
        ({"reward": {"signed_ordre": 1.0}}, 'one of "signed_order"'),
        ({"observation": {"neighbor": 3}}, '"target", "neighbors"'),
        ({"target": "clockwise"}, '"cw", "ccw", "random", "alternate"'),
        ({"preset": "simulaton"}, "simulation"),
        ({"n_leaders": 0}, "at least 1 in an environment"),
        ({"n_leaders": 10}, "n_leaders = 10"),
        ({"control_hz": 0.0}, "control_hz = 0"),
        ({"control_hz": float("nan")}, "control_hz"),
        ({"episode_s": 0.0}, "episode_s = 0"),
        ({"episode_s": float("inf")}, "episode_s"),
        ({"bw_s": (0.5, 0.2)}, "bw_s = (0.5, 0.2)"),
        ({"bw_s": (0.5, float("nan"))}, "bw_s"),
        ({"dropout_rate": 1.0}, "dropout_rate = 1"),
        ({"delay_frames": 2}, "delay_frames = 2"),
        ({"rudder_levels": 1}, "rudder_levels = 1"),
        ({"rudder_lag_s": -1.0}, "rudder_lag_s = -1"),
        ({"rudder_rate_per_s": 0.0}, "rudder_rate_per_s = 0"),
        ({"reward": {"signed_order": float("nan")}}, "signed_order: NaN"),
        ({"observation": {"neighbors": 65}}, "neighbors = 65"),
        ({"observation": NOTHING}, "observation"),
        ({"n_leaders": 9}, "n_boats > n_leaders"),
        ({"render_mode": "ansi"}, "render_mode = 'ansi'"),
        ({"dt_s": 0.0}, "dt_s = 0"),
        ({"physics": "coarse"}, '"default", "training"'),
        ({"physics": 1}, "physics"),
        ({"physics": "training", "dt_s": 0.1}, "physics = 'training' and dt_s are both given"),
        ({"action_mode": "leen"}, 'one of "rudder", "heading", "lean"'),
        ({"action_mode": "lean", "pool": (100.0, 40.0)}, "wide and narrow"),
        ({"decision_period_s": 0.25}, "0.2 and 0.3 s are nearest"),
        ({"decision_period_s": 0.04}, "0.1 s is nearest"),
        ({"decision_period_s": 0.0}, "whole number of control steps"),
        ({"decision_period_s": float("nan")}, "whole number of control steps"),
        ({"decision_period_s": -1.0}, "whole number of control steps"),
        ({"reward_horizon_s": 0.0}, "positive number"),
        ({"observation": {"lean_features": True}, "pool": (100.0, 40.0)}, "wide and narrow"),
    ],
)
def test_options(interface, options, message):
    with pytest.raises((ParameterError, TypeError)) as caught:
        interface(**options)
    assert message in str(caught.value) or not isinstance(caught.value, ParameterError)


def test_params_and_preset_exclude_each_other():
    params = flockenv.FlockParameters(n_boats=5, n_leaders=1)
    with pytest.raises(ParameterError, match="both given"):
        flockenv.LeadersEnv(params=params, preset="paper")
    assert flockenv.LeadersEnv(params=params).parameters == params
    assert flockenv.LeadersEnv(params=params, bw_s=0.7).parameters.bw_s == 0.7
    assert flockenv.LeadersEnv(preset="paper").parameters.scheme == "paper"


def zeros(env):
    if isinstance(env, flockenv.LeadersParallelEnv):
        return {agent: np.zeros(1) for agent in env.possible_agents}
    return np.zeros(env.action_space.shape)


def test_stepping_before_a_reset_and_after_the_end(interface):
    env = interface(autoreset_mode="disabled") if interface.__name__ == "vector" else interface()
    with pytest.raises(EpisodeError, match="reset"):
        env.step(zeros(env))
    env.reset(seed=0)
    if isinstance(env, flockenv.LeadersVectorEnv):
        return
    for _ in range(10):
        env.step(zeros(env))
    before = env.get_state()
    with pytest.raises(EpisodeError):
        env.step(zeros(env))
    assert env.get_state() == before
    env.reset()
    env.step(zeros(env))


def test_nan_and_wrong_shapes_move_nothing():
    for env in (flockenv.LeadersEnv(**OPTIONS), flockenv.LeadersVectorEnv(3, **OPTIONS)):
        env.reset(seed=0)
        before = env.get_state()
        good = np.zeros(env.action_space.shape)
        one_nan = good.copy()
        one_nan.flat[-1] = np.nan
        for actions in (one_nan, good[..., :1], good[..., None], 0.0, [[1.0], [2.0, 3.0]]):
            with pytest.raises(ParameterError):
                env.step(actions)
        for actions in (good.astype(object), good.astype(complex), np.full(good.shape, "a")):
            with pytest.raises(TypeError):
                env.step(actions)
        assert env.get_state() == before
        env.step(good)


def test_levels_out_of_range():
    env = flockenv.LeadersEnv(rudder_levels=3, **OPTIONS)
    env.reset(seed=0)
    before = env.get_state()
    # A rudder of 1.0 is not level 1.
    for actions in ([0, 3], [-1, 0], [0.5, 0], [1.0, 0.0]):
        with pytest.raises(ParameterError, match="whole numbers from 0 to 2"):
            env.step(actions)
    assert env.get_state() == before


def test_agents_that_are_not_there():
    env = flockenv.parallel_env(**OPTIONS)
    env.reset(seed=0)
    before = env.get_state()
    good = zeros(env)
    for actions in (
        {"leader_0": np.zeros(1)},
        {**good, "leader_2": np.zeros(1)},
        {**good, "leader_1": np.zeros(2)},
        {**good, "leader_1": 0.0},
        {**good, "leader_1": np.array([np.nan])},
        {**good, "leader_1": [[1.0], [2.0, 3.0]]},
        {},
    ):
        with pytest.raises(ParameterError):
            env.step(actions)
    for actions in (None, [0.0, 0.0], {**good, "leader_1": [True]}, {**good, "leader_1": ["a"]}):
        with pytest.raises(TypeError, match="action"):
            env.step(actions)
    assert env.get_state() == before
    with pytest.raises(KeyError):
        env.observation_space("leader_2")


@pytest.mark.parametrize(
    "options",
    [
        {"targt": "cw"},
        {"target": "up"},
        {"bw_s": -1.0},
        {"state": {"pose": np.zeros((9, 3))}},
        {"state": {"velocity": np.zeros((9, 3))}},
        {"state": {"pose": np.full((9, 3), np.nan)}},
        {"state": {"pose": np.zeros((8, 3))}},
        {"state": {"pos": np.zeros((9, 3))}},
        {"snapshot": b"nonsense"},
        {"snapshot": b""},
        {"snapshot": flockenv.Flock(flockenv.FlockParameters(n_boats=5), 0).snapshot()},
    ],
)
def test_reset_options(interface, options):
    env = interface()
    env.reset(seed=0)
    before = env.get_state()
    with pytest.raises(FlockError):
        env.reset(seed=1, options=options)
    assert env.get_state() == before
    env.step(zeros(env))


@pytest.mark.parametrize("options", [5, "abc", [], [("target", "cw")]])
def test_reset_options_that_are_no_dictionary(interface, options):
    with pytest.raises(TypeError, match="reset options must be a dictionary"):
        interface().reset(seed=0, options=options)


@pytest.mark.parametrize("time_s", [1e9, 1e9 - 0.5])
def test_episodes_end_before_the_end_of_time(interface, time_s):
    # Beyond it a state could be put away, but not brought back.
    env = interface()
    env.reset(seed=0)
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=2)
    flock = flockenv.Flock(parameters, 0)
    late = {"pose": flock.pose, "time_s": time_s}
    flock.set_state(flock.pose, flock.velocity, time_s=time_s)
    for options in ({"state": late}, {"snapshot": flock.snapshot()}):
        with pytest.raises(ParameterError, match="time_s"):
            env.reset(seed=0, options=options)
    env.reset(seed=0, options={"state": {**late, "time_s": 1e9 - 1.0}})
    for _ in range(10):
        env.step(zeros(env))
    env.set_state(env.get_state())


def test_vector_seeds_options_and_masks():
    env = flockenv.LeadersVectorEnv(3, **OPTIONS)
    env.reset(seed=0)
    before = env.get_state()
    for bad in (
        {"seed": [1, 2]},
        {"options": {"target": ["cw"]}},
        {"options": {"reset_mask": np.ones(2, bool)}},
        {"options": {"reset_mask": np.zeros(3, bool)}},
    ):
        with pytest.raises(ParameterError):
            env.reset(**bad)
    for mask in ([True, False, True], np.ones(3)):
        with pytest.raises(TypeError):
            env.reset(options={"reset_mask": mask})
    assert env.get_state() == before
    for bad in ({"num_envs": 0}, {"autoreset_mode": "sometimes"}):
        with pytest.raises(ParameterError):
            flockenv.LeadersVectorEnv(**bad)


@pytest.mark.parametrize("name", ["observe", "state"])
def test_nothing_is_observed_before_the_first_reset(interface, name):
    with pytest.raises(flockenv.EpisodeError, match="reset has not been called yet"):
        getattr(interface(), name)()
