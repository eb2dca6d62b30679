"""Train three leaders with IPPO or MAPPO of BenchMARL: the suite's baselines of other learners.

    python baselines/train_with_benchmarl.py ippo SEED FLOCK_HOURS FOLDER

With 1000 flock-hours, seeds 0 to 2 score -0.003 to +0.011 in the suite with IPPO and +0.002 to
+0.003 with MAPPO: no gain on the tuned law is shown.

The flocks, the action (a lean, decided once per second), the reward and the horizons are those of
examples/train_leaders.py. The learner is BenchMARL's own: a network with two hidden layers that all
leaders share, which sees the default observation, and noise of its action. The critic of MAPPO sees
features of the whole flock. FOLDER gets policy.npz, which every command takes, and BenchMARL's own
files. Needs the extra benchmarl.

The design of the suite's baselines was fixed before their trainings: IPPO and MAPPO by this file,
PPO by examples/train_leaders.py and the evolution strategy by baselines/evolution_strategy.py, with
100 and with 1000 flock-hours, seeds 0 to 2 each. The settings here were not searched: MAPPO with
seed 10 and 250 flock-hours ran once before, and was level with the tuned law.
"""

import sys
import time
from pathlib import Path

import torch
from benchmarl.algorithms import IppoConfig, MappoConfig
from benchmarl.experiment import Experiment, ExperimentConfig
from benchmarl.models import MlpConfig
from provenance import provenance_of

from flockenv import FlockParameters
from flockenv.benchmarl import LeadersTask, network_policy

ALGORITHMS = {"ippo": IppoConfig, "mappo": MappoConfig}
TASK = {
    "pool": "wide",
    "n_boats": 27,
    "bw_s": FlockParameters.critical_bw_s("simulation", "wide"),
    "n_leaders": 3,
    "target": "random",
    "mirror_to_target": True,
    "action_mode": "lean",
    "decision_period_s": 1.0,
    "reward": {"signed_order": 1.0, "contact_alignment": 30.0},
    "reward_horizon_s": 40.0,
    "episode_s": 480.0,
    "physics": "training",
    "state": "features",
}
#: Flocks, and decisions of each in a rollout.
FLOCKS, DECISIONS = 128, 240


def experiment(name: str, seed: int, hours: float, folder: Path) -> Experiment:
    """Return the experiment, whose frames are seconds of a flock, in whole rollouts."""
    config = ExperimentConfig.get_from_yaml()
    rollout = FLOCKS * DECISIONS
    config.max_n_frames = max(round(hours * 3600 / rollout), 1) * rollout
    config.on_policy_collected_frames_per_batch = rollout
    config.on_policy_n_envs_per_worker = FLOCKS
    config.on_policy_minibatch_size = rollout // 8
    config.on_policy_n_minibatch_iters = 4
    config.gamma, config.lr = 0.995, 5e-4
    config.evaluation, config.loggers, config.render = False, ["csv"], False
    config.checkpoint_at_end, config.save_folder = True, str(folder)
    algorithm = ALGORITHMS[name].get_from_yaml()
    algorithm.lmbda, algorithm.entropy_coef = 0.9875, 0.0
    task = LeadersTask.LEADERS.get_from_yaml()
    task.config = TASK
    network = MlpConfig.get_from_yaml()
    network.num_cells, network.activation_class = [64, 64], torch.nn.Tanh
    return Experiment(
        algorithm_config=algorithm,
        model_config=network,
        critic_model_config=network,
        task=task,
        seed=seed,
        config=config,
    )


def main(name: str, seed: int, hours: float, folder: Path) -> None:
    """Train, and save the policy."""
    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    start, training = time.perf_counter(), experiment(name, seed, hours, folder)
    training.run()
    provenance = provenance_of(
        f"python baselines/train_with_benchmarl.py {name} {seed} {hours:g} {folder}",
        seed=seed,
        samples=training.total_frames * TASK["n_leaders"],
        wall_s=time.perf_counter() - start,
        flock_hours=training.total_frames / 3600,
    )
    network_policy(training, provenance).save(folder / "policy.npz")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), Path(sys.argv[4]))
