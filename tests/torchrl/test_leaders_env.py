"""Law: TorchRL's environment is the native vector environment, agent by agent, bit for bit."""

import copy
import pickle

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import state_entries
from flockenv.errors import ParameterError

torch = pytest.importorskip("torch")
pytest.importorskip("torchrl")

from pettingzoo.utils import BaseParallelWrapper, parallel_to_aec  # noqa: E402 - after the check above
from torchrl.envs import PettingZooWrapper  # noqa: E402
from torchrl.envs.utils import check_env_specs, step_mdp  # noqa: E402

from flockenv.torchrl import LeadersEnv  # noqa: E402

SHORT = {"n_boats": 8, "n_leaders": 2, "episode_s": 2.0}
VARIANTS = {
    "default": {},
    "one flock, one leader": {"num_flocks": 1, "n_leaders": 1},
    "discrete": {"rudder_levels": 5},
    "mirrored": {"mirror_to_target": True, "target": "random"},
    "lean, held": {"action_mode": "lean", "decision_period_s": 0.5},
    "few blocks": {"observation": {"neighbors": 0, "order": False}},
    "features": {"state": "features"},
    "set": {"state": "set"},
    "no state": {"state": "none"},
}


def made(**options):
    return LeadersEnv(**{"num_flocks": 3, **SHORT, **options})


def native(**options):
    return flockenv.LeadersVectorEnv(3, autoreset_mode="disabled", **{**SHORT, **options})


def acted(env, rudders):
    """Return the reset's tensors with these rudders in them, (flocks, leaders)."""
    step = env.reset()
    step["leaders", "action"] = torch.as_tensor(rudders, dtype=torch.float32).unsqueeze(-1)
    return step


@pytest.mark.parametrize("options", VARIANTS.values(), ids=VARIANTS.keys())
def test_check_env_specs(options):
    env = made(**options)
    check_env_specs(env, seed=0)
    rollout = env.rollout(30, break_when_any_done=False)
    assert rollout.shape == (env.num_flocks, 30)
    decisions = env.episode_steps
    assert rollout["next", "truncated"].sum() == env.num_flocks * (30 // decisions)
    assert not rollout["next", "terminated"].any()
    # What a step says last is not what the next episode starts with.
    if decisions < 30:
        last = rollout["next", "leaders", "observation"][:, decisions - 1]
        assert not torch.equal(last, rollout["leaders", "observation"][:, decisions])


def test_a_step_without_an_action_is_named():
    env = made()
    with pytest.raises(KeyError, match='"action" not found'):
        env.step(env.reset())


@pytest.mark.parametrize("state", ["boats", "features"])
def test_the_bits_are_those_of_the_vector_environment(state):
    env, vector = made(state=state), native()
    env.set_seed(7)
    observations, _ = vector.reset(seed=7)
    step = env.reset()
    random = np.random.default_rng(0)
    for _ in range(20):
        seen = step["leaders", "observation"]
        np.testing.assert_array_equal(seen.reshape(3, -1).numpy(), observations)
        state_now = vector.state() if state == "boats" else vector.flock_features()
        np.testing.assert_array_equal(step["state"].numpy(), state_now)
        rudders = random.uniform(-1, 1, (3, 2)).astype(np.float32)
        step["leaders", "action"] = torch.from_numpy(rudders).unsqueeze(-1)
        stepped = env.step(step)
        observations, rewards, _, truncated, _ = vector.step(rudders)
        own = stepped["next", "leaders", "reward"]
        np.testing.assert_allclose(own.mean(dim=(1, 2)).numpy(), rewards, rtol=1e-6, atol=1e-7)
        np.testing.assert_array_equal(stepped["next", "truncated"][:, 0].numpy(), truncated)
        step = step_mdp(stepped)
    assert truncated.all()


def test_a_set_has_a_row_for_each_boat():
    env, whole = made(state="set"), made()
    for each in (env, whole):
        each.set_seed(1)
    rows, flat = (each.reset()["state"] for each in (env, whole))
    boat, clock = (len(each) for each in (state_entries(1), state_entries(0)))
    assert rows.shape == (3, 8, boat)
    assert torch.equal(rows[:, 3, : boat - clock], flat[:, 3 * 10 : 4 * 10])
    for place in range(8):
        assert torch.equal(rows[:, place, -clock:], flat[:, -clock:])


def test_a_mask_resets_some_flocks_alone():
    env, vector = made(), native()
    env.set_seed(3)
    vector.reset(seed=3)
    stepped = env.step(acted(env, np.zeros((3, 2))))
    vector.step(np.zeros((3, 2), np.float32))
    step = step_mdp(stepped)
    before = step["leaders", "observation"].clone()
    step["_reset"] = torch.tensor([[False], [True], [False]])
    after = env.reset(step)["leaders", "observation"]
    mask = np.array([False, True, False])
    expected = vector.reset(options={"reset_mask": mask})[0]
    np.testing.assert_array_equal(after.reshape(3, -1).numpy(), expected)
    torch.testing.assert_close(after[[0, 2]], before[[0, 2]], rtol=0, atol=0)
    assert not torch.equal(after[1], before[1])


def test_a_seed_waits_for_the_reset_of_its_flock():
    env, fresh = made(), made()
    fresh.set_seed(5)
    expected = fresh.reset()["leaders", "observation"]
    step = env.reset().set("_reset", torch.tensor([[True], [False], [False]]))
    env.set_seed(5)
    assert torch.equal(env.reset(step)["leaders", "observation"][0], expected[0])
    # Flock 0 has used its seed up by now, and continues with the episode that follows.
    then = env.reset()["leaders", "observation"]
    assert torch.equal(then[1:], expected[1:])
    assert not torch.equal(then[0], expected[0])


def test_reset_options_reach_the_flocks():
    env = made(state="features")
    starts = [env.reset(options={"target": target}) for target in ("cw", "ccw")]
    assert env._batch.core.episode(0)["target"] == "ccw"
    assert len(starts) == 2
    with pytest.raises(ParameterError, match="did you mean 'target'"):
        env.reset(options={"Target": "cw"})


@pytest.mark.parametrize("state", ["boats", "set", "features"])
def test_copies_and_pickles_continue_with_the_same_bits(state):
    env = made(state=state)
    env.set_seed(2)
    step = acted(env, np.full((3, 2), 0.5))
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        ours, theirs = (each.step(step.clone())["next"] for each in (copy.deepcopy(env), other))
        assert (ours == theirs).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"num_flocks": 0}, "num_flocks = 0 is not accepted"),
        ({"num_flocks": 10**9}, "num_flocks = 1000000000 is not accepted"),
        ({"state": "boat"}, "'boat' is not a state: did you mean 'boats'"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(ParameterError, match=message):
        made(**options)


class WithoutInfos(BaseParallelWrapper):
    """As on the page: torchrl makes tensors of infos, the same ones in every step."""

    def reset(self, seed=None, options=None):
        observations, infos = self.env.reset(seed, options)
        return observations, {agent: {} for agent in infos}


@pytest.mark.filterwarnings("ignore:PettingZoo in TorchRL is tested")
@pytest.mark.parametrize("options", [{}, {"target": ["cw", "ccw"]}, {"rudder_levels": 5}])
def test_torchrls_own_wrapper_takes_the_agents_without_their_infos(options):
    options = {**SHORT, **options}
    env = PettingZooWrapper(WithoutInfos(flockenv.parallel_env(**options)), return_state=True)
    env.set_seed(3)
    check_env_specs(env)
    agents = flockenv.parallel_env(**options)
    observations, _ = agents.reset(seed=3)
    seen = env.reset(seed=3)["leader", "observation"].numpy()
    assert np.array_equal(seen, [*observations.values()])
    assert env.rollout(30).shape == (20,)
    in_turn = parallel_to_aec(WithoutInfos(flockenv.parallel_env(**options)))
    assert PettingZooWrapper(in_turn, use_mask=True).rollout(6).shape == (6,)
