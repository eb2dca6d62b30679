"""Law: BenchMARL trains on the tasks, and what it learned steers as it did there.

It needs an older TorchRL: `make test-benchmarl`.
"""

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import flockenv
from flockenv.errors import ParameterError, UnknownOptionError

pytestmark = [
    pytest.mark.benchmarl,
    pytest.mark.timeout(600),
    # BenchMARL's own use of libraries that have moved on.
    pytest.mark.filterwarnings("ignore"),
]

torch = pytest.importorskip("torch")
pytest.importorskip("benchmarl")

from benchmarl.algorithms import IddpgConfig, IppoConfig, MaddpgConfig, MappoConfig  # noqa: E402 - after the check above
from benchmarl.environments import task_config_registry  # noqa: E402
from benchmarl.experiment import Experiment, ExperimentConfig  # noqa: E402
from benchmarl.models import DeepsetsConfig, GnnConfig, MlpConfig  # noqa: E402
from torchrl.envs.utils import (  # noqa: E402
    ExplorationType,
    check_env_specs,
    set_exploration_type,
)

from flockenv.benchmarl import CONF, LeadersTask, network_policy  # noqa: E402
from flockenv.runs.seeds import POLICY_SEEDS  # noqa: E402

SMALL = {"n_boats": 6, "n_leaders": 2, "pool": "narrow", "episode_s": 2.0}


def short(tmp_path, **changes):
    config = ExperimentConfig.get_from_yaml()
    config.max_n_frames = config.on_policy_collected_frames_per_batch = 40
    config.off_policy_collected_frames_per_batch = 40
    config.evaluation_interval = 40
    config.evaluation_episodes = 2
    config.on_policy_n_envs_per_worker = 2
    config.on_policy_n_minibatch_iters = 1
    config.on_policy_minibatch_size = 20
    config.loggers = ["csv"]
    config.create_json = False
    config.save_folder = str(tmp_path)
    for name, value in changes.items():
        setattr(config, name, value)
    return config


def experiment(tmp_path, *, critic, state, actor=MlpConfig, algorithm=None, n_leaders=2, **changes):
    discrete = changes.get("prefer_continuous_actions") is False
    levels = {"rudder_levels": 5} if discrete else {}
    return Experiment(
        task=LeadersTask.LEADERS.get_task(
            {**SMALL, **levels, "n_leaders": n_leaders, "state": state}
        ),
        algorithm_config=MappoConfig.get_from_yaml() if algorithm is None else algorithm,
        model_config=actor.get_from_yaml(),
        critic_model_config=critic.get_from_yaml(),
        seed=0,
        config=short(tmp_path, **changes),
    )


@pytest.mark.parametrize("task", list(LeadersTask))
def test_tasks_are_read_from_their_files(task):
    loaded = task.get_from_yaml()
    assert loaded.config["n_boats"] in (9, 27)
    assert task_config_registry[f"flockenv/{task.name.lower()}"] is task
    assert (CONF / "task" / "flockenv" / f"{task.name.lower()}.yaml").exists()
    assert pickle.loads(pickle.dumps(loaded)) == loaded
    env = loaded.get_env_fun(3, continuous_actions=True, seed=1, device="cpu")()
    check_env_specs(env)
    assert loaded.max_steps(env) == {"LEADERS": 2400, "LEAN": 20}[task.name]
    assert loaded.group_map(env) == {
        "leaders": [f"leader_{leader}" for leader in range(env.num_leaders)]
    }


def test_a_run_has_training_seeds_of_its_own():
    task = LeadersTask.LEADERS.get_task(dict(SMALL))
    env = task.get_env_fun(2, continuous_actions=True, seed=3, device="cpu")()
    env.reset()
    seeds = POLICY_SEEDS["training"].seeds(2, run=3)
    native = flockenv.LeadersVectorEnv(2, **SMALL)
    expected, _ = native.reset(seed=list(seeds))
    observed = env._batch.core.observe().reshape(2, -1)
    np.testing.assert_array_equal(observed, expected)


@pytest.mark.parametrize(
    ("critic", "state"), [(DeepsetsConfig, "set"), (GnnConfig, "none"), (MlpConfig, "features")]
)
def test_mappo_learns_a_policy_that_steers_here(tmp_path, critic, state):
    run = experiment(tmp_path, critic=critic, state=state)
    run.run()
    policy = network_policy(run, {"learner": "MAPPO"})
    policy.save(tmp_path / "policy.npz")
    loaded = flockenv.policies.load(tmp_path / "policy.npz")
    assert loaded.provenance == {"learner": "MAPPO"}
    steers_as_in(run, loaded)


def steers_as_in(run, policy):
    with torch.no_grad(), set_exploration_type(ExplorationType.DETERMINISTIC):
        rollout = run.test_env.rollout(20, run.policy)
    rows = rollout["leaders", "observation"]
    expected = rollout["leaders", "action"][..., 0].numpy()
    assert expected.std() > 1e-4
    rudders = policy.predict(rows.flatten(-2).numpy())[0]
    np.testing.assert_allclose(rudders, expected, atol=1e-5)


@pytest.mark.parametrize("algorithm", [IddpgConfig, MaddpgConfig])
@pytest.mark.parametrize("is_squashed", [True, False])
def test_deterministic_learners_squash_what_their_policies_squash(tmp_path, algorithm, is_squashed):
    config = algorithm.get_from_yaml()
    config.use_tanh_mapping = is_squashed
    run = experiment(tmp_path, critic=MlpConfig, state="none", algorithm=config)
    policy = network_policy(run)
    assert (policy.activations[-1] == "tanh") == is_squashed
    steers_as_in(run, policy)


def test_a_leader_alone_needs_no_shared_network(tmp_path):
    run = experiment(
        tmp_path, critic=MlpConfig, state="none", n_leaders=1, share_policy_params=False
    )
    steers_as_in(run, network_policy(run))
    steers_as_in(run, network_policy(run))


def test_a_graph_network_learns_and_is_no_policy_of_one_leader(tmp_path):
    run = experiment(tmp_path, critic=GnnConfig, actor=GnnConfig, state="none")
    run.run()
    with pytest.raises(ParameterError, match="one MLP that all leaders share"):
        network_policy(run)


def test_policies_of_leaders_that_share_nothing_are_refused(tmp_path):
    run = experiment(
        tmp_path,
        critic=MlpConfig,
        state="none",
        algorithm=IppoConfig.get_from_yaml(),
        share_policy_params=False,
    )
    with pytest.raises(ParameterError, match="one MLP that all leaders share"):
        network_policy(run)


def test_the_command_finds_the_tasks(tmp_path):
    command = [
        *(sys.executable, "-m", "flockenv.benchmarl", "task=flockenv/lean", "algorithm=mappo"),
        *("model@critic_model=layers/deepsets", "task.n_boats=6", "experiment.loggers=[csv]"),
        *("experiment.max_n_frames=40", "experiment.on_policy_collected_frames_per_batch=40"),
        *("experiment.on_policy_n_envs_per_worker=2", "experiment.evaluation=false"),
        *("experiment.on_policy_n_minibatch_iters=1", "experiment.on_policy_minibatch_size=20"),
        f"hydra.run.dir={tmp_path}",
    ]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, env={**os.environ}, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "n_boats: 6" in done.stdout
    assert list(tmp_path.rglob("*.csv"))


@pytest.mark.parametrize(
    ("config", "error", "message"),
    [
        ({"n_boat": 6}, UnknownOptionError, "did you mean 'n_boats'"),
        ({"state": "sets"}, ParameterError, "did you mean 'set'"),
        ({"n_leaders": [1, 2]}, (ParameterError, TypeError), "n_leaders"),
    ],
)
def test_bad_configurations_are_named(config, error, message):
    with pytest.raises(error, match=message):
        LeadersTask.LEADERS.get_task(config)


def test_the_notebook_trains_and_judges(run_notebook, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = run_notebook("with_benchmarl.ipynb", FLOCKS="16", ITERATIONS="1", JUDGED="4")
    assert {name: each.shape for name, each in names["orders"].items()} == {
        "no lean": (4,),
        "learned": (4,),
    }
    assert (names["orders"]["learned"] != names["orders"]["no lean"]).any()
    flockenv.policies.load(tmp_path / "policy.npz")
