"""Law: bad input is a named error, and nothing has moved."""

import numpy as np
import pytest

import flockenv
from flockenv import EpisodeError, FlockError, ParameterError
from flockenv.envs.options import NAMES
from flockenv.envs.reset_options import RESET_OPTIONS

from .conftest import EVERY, INTERFACES, torchrl_env, zeros

OPTIONS = {"n_boats": 9, "n_leaders": 2, "episode_s": 1.0}
NOTHING = dict.fromkeys(["own", "phase", "target", "order", "neighbors"], 0)


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
        ({"reward": {"signed_order": True}}, "reward must be"),
        ({"reward": {"signed_order": "1.0"}}, "reward must be"),
        ({"reward": {"signed_order": 1 + 0j}}, "reward must be"),
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
        ({"decision_period_s": 1e-30}, "0.1 s is nearest"),
        ({"decision_period_s": 0.0}, "whole number of control steps"),
        ({"decision_period_s": float("nan")}, "whole number of control steps"),
        ({"decision_period_s": -1.0}, "whole number of control steps"),
        ({"reward_horizon_s": 0.0}, "positive number"),
        ({"reward_horizon_s": 0.099}, "at least one control step of 0.1 s"),
        ({"reward_horizon_s": 1e-300, "control_hz": 2.5}, "at least one control step of 0.4 s"),
        ({"observation": {"lean_features": True}, "pool": (100.0, 40.0)}, "wide and narrow"),
    ],
)
def test_options(interface, options, message):
    with pytest.raises((ParameterError, TypeError)) as caught:
        interface(**options)
    assert message in str(caught.value) or not isinstance(caught.value, ParameterError)


@pytest.mark.parametrize("weight", [True, "1.0", b"1.0", None, 1 + 0j, np.bool_(True), [1.0]])
def test_weights_are_numbers(weight):
    make = flockenv.LeadersVectorEnv
    for reward in ({"signed_order": weight}, [{"signed_order": 1.0}, {"signed_order": weight}]):
        with pytest.raises(TypeError, match="reward"):
            make(1, **OPTIONS, reward=reward)
    make(1, **OPTIONS, reward=({"jam": each} for each in (np.float32(0.5), 2)))
    with pytest.raises((TypeError, ParameterError), match=r"accepted|must be"):
        flockenv.policies.LeaningLaw("wide", 0.0, {"near": weight})
    size = len(flockenv.envs.observation.observation_entries())
    if not isinstance(weight, list):
        with pytest.raises(ParameterError, match="layer 0 is not accepted"):
            flockenv.policies.NetworkPolicy([[[weight]] * size], [[0.0]])


def test_params_and_preset_exclude_each_other():
    params = flockenv.FlockParameters(n_boats=5, n_leaders=1)
    with pytest.raises(ParameterError, match="both given"):
        flockenv.LeadersEnv(params=params, preset="paper")
    assert flockenv.LeadersEnv(params=params).parameters == params
    assert flockenv.LeadersEnv(params=params, bw_s=0.7).parameters.bw_s == 0.7
    assert flockenv.LeadersEnv(preset="paper").parameters.scheme == "paper"


def test_stepping_before_a_reset_and_after_the_end(interface):
    env = interface()
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
    "action", [None, "left", [np.nan], [0.0, 0.0], {"leader_0": [0.0]}, [True], [[0.0]]]
)
def test_what_is_no_action_is_refused_in_its_agents_turn(action):
    env = flockenv.env(**OPTIONS)
    env.reset(seed=0)
    with pytest.raises((TypeError, ParameterError), match="the action of leader_0"):
        env.step(action)
    assert env.agent_selection == "leader_0"
    for agent in env.agent_iter():
        over = env.terminations[agent] or env.truncations[agent]
        env.step(None if over else np.zeros(1))


@pytest.mark.parametrize(
    "options",
    [
        {"Target": "cw"},
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


ENVIRONMENT = [
    *(name for name in NAMES if name not in RESET_OPTIONS),
    *("seed", "render_mode", "render_size", "autoreset_mode", "num_envs", "num_flocks"),
]


def resets(interface):
    """Return what gives options to a reset of any interface."""
    env = interface()
    if hasattr(env, "set_options"):
        return lambda options: (env.set_options(options), env.reset())
    if not hasattr(env, "get_state"):
        return lambda options: env.reset(options=options)

    def reset(options):
        before = env.get_state()
        try:
            env.reset(options=options)
        except ParameterError:
            assert env.get_state() == before
            raise

    env.reset(seed=0)
    return reset


@pytest.fixture(params=EVERY.values(), ids=EVERY.keys())
def every(request):
    return resets(lambda: request.param(**OPTIONS))


def test_options_of_the_environment_are_no_options_of_a_reset(every):
    for name in ENVIRONMENT:
        for written in (name, name.upper(), name.title(), name.replace("_", "-")):
            with pytest.raises(ParameterError, match="not a reset option") as raised:
                every({written: 3})
            words = str(raised.value)
            assert repr(written) in words
            assert "target, bw_s, state" in words or "did you mean" in words
    for name in RESET_OPTIONS:
        every({} if name in ("state", "snapshot", "noise_seed") else {name: OF_EACH[name]})


OF_EACH = {"target": "ccw", "bw_s": 0.5}


@pytest.mark.parametrize(
    "name",
    [
        *("bw", "BW", "Bw_S", "bws", "bw-s", "bw_sec", "BW_S", "bw_cm", " bw_s"),
        *("Target", "TARGET", "State", "STATE", "Snapshot", "snap_shot", "SNAPSHOT", "noise-seed"),
        *("nboats", "N_BOATS", "DT_S", "C4", "Pool", "Seed", "Reward", "physics"),
        *("pose", "velocity", "time_s", "allow_overlap", "Pose", "VELOCITY", "allow-overlap"),
    ],
)
def test_what_would_do_nothing_in_a_reset_is_refused(every, name):
    with pytest.raises(ParameterError, match="not a reset option"):
        every({name: 0.5})


@pytest.mark.parametrize("name", ["pose", "velocity", "time_s", "allow_overlap"])
def test_keys_of_a_state_belong_into_it(every, name):
    with pytest.raises(ParameterError, match=f"{name!r} is a key of 'state'"):
        every({name: np.zeros((9, 3))})


@pytest.mark.parametrize("options", [{"stage_of": 3}, {"record_video": True}, {"goal": 1, 7: 8}])
def test_keys_of_wrappers_pass(interface, options):
    env = interface()
    env.reset(seed=0, options={**options, "bw_s": 0.5})
    episodes = env._batch.core.episode
    assert [episodes(flock)["bw_s"] for flock in range(env._batch.num_flocks)] == [
        0.5
    ] * env._batch.num_flocks


def test_a_mask_has_its_own_name(every):
    with pytest.raises(ParameterError, match="not a reset option"):
        every({"RESET_MASK": np.ones(3, bool)})


@pytest.mark.parametrize("name", ["single", "parallel", "gymnasium.make", "aec", "sb3", "torchrl"])
def test_a_mask_is_for_vector_environments(name):
    with pytest.raises(ParameterError, match="not a reset option"):
        resets(lambda: EVERY[name](**OPTIONS))({"reset_mask": np.ones(3, bool)})


@pytest.mark.parametrize("given", [{"bw_s": 0.5}, {"seed": 3}, {"anything": 1}])
def test_what_torchrl_passes_on_is_taken_or_refused(given):
    env = torchrl_env(**OPTIONS)
    with pytest.raises(flockenv.errors.UnknownOptionError, match=r"options=.*set_seed"):
        env.reset(**given)
    env.reset(options={"bw_s": 0.5})


def test_lists_of_one_environment_and_of_many():
    """Of many a list has an entry for each; of one it is the value: a range, a leader's each."""
    env = flockenv.LeadersEnv(**OPTIONS)
    for bw_s in ([0.25, 0.75], (0.25, 0.75), np.array([0.25, 0.75]), iter([0.25, 0.75])):
        env.reset(seed=0, options={"bw_s": bw_s})
        assert 0.25 < env.episode()["bw_s"] < 0.75
    env.reset(seed=0, options={"bw_s": np.array(0.5)})
    assert env.episode()["bw_s"] == 0.5
    for target in (["cw", "ccw"], np.array(["cw", "ccw"]), (each for each in ("cw", "ccw"))):
        env.reset(seed=0, options={"target": target})
        assert env.episode()["target"] == ("cw", "ccw")
    many = flockenv.LeadersVectorEnv(3, **OPTIONS)
    numbers = [0.25, 0.5, 0.75]
    for bw_s in (numbers, np.array(numbers), iter(numbers), dict(enumerate(numbers)).values()):
        _, infos = many.reset(seed=0, options={"bw_s": bw_s})
        assert infos["bw_s"].tolist() == numbers
    _, infos = many.reset(seed=0, options={"target": ("cw", "ccw")})
    assert [*map(tuple, infos["target"])] == [("cw", "ccw")] * 3


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
