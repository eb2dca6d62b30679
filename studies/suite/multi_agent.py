"""IPPO and MAPPO of BenchMARL, for studies: the leaders of a flock share one network."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from torch import nn


@dataclass(frozen=True)
class MultiAgent:
    """One training; its critic has the layers of `critic`, and of MAPPO it sees the whole flock."""

    #: "ippo" or "mappo".
    algorithm: str
    seed: int
    #: Decisions of flocks; the last rollout may add some.
    frames: int
    #: Flocks of a rollout, and decisions of each.
    flocks: int
    steps: int
    #: Decisions of flocks in a batch, and passes over a rollout.
    minibatch: int
    epochs: int
    learning_rate: float
    gamma: float
    lmbda: float
    hidden: Sequence[int]
    critic: Sequence[int]

    def experiment(self, options: dict[str, Any], folder: str) -> Any:
        """Return the experiment of BenchMARL in an environment, ready to run."""
        from benchmarl.algorithms import IppoConfig, MappoConfig
        from benchmarl.experiment import Experiment, ExperimentConfig
        from benchmarl.models import MlpConfig

        from flockenv.benchmarl import LeadersTask

        config = ExperimentConfig.get_from_yaml()
        config.max_n_frames, config.gamma, config.lr = self.frames, self.gamma, self.learning_rate
        config.on_policy_collected_frames_per_batch = self.flocks * self.steps
        config.on_policy_n_envs_per_worker = self.flocks
        config.on_policy_minibatch_size = self.minibatch
        config.on_policy_n_minibatch_iters = self.epochs
        config.evaluation, config.loggers, config.render = False, [], False
        config.save_folder = folder
        kind = {"ippo": IppoConfig, "mappo": MappoConfig}[self.algorithm]
        algorithm, task = kind.get_from_yaml(), LeadersTask.LEADERS.get_from_yaml()
        algorithm.lmbda, algorithm.entropy_coef = self.lmbda, 0.0
        task.config = {**options, "state": "features"}
        actor, critic = MlpConfig.get_from_yaml(), MlpConfig.get_from_yaml()
        actor.num_cells, actor.activation_class = list(self.hidden), nn.Tanh
        critic.num_cells, critic.activation_class = list(self.critic), nn.Tanh
        return Experiment(
            algorithm_config=algorithm,
            model_config=actor,
            critic_model_config=critic,
            task=task,
            seed=self.seed,
            config=config,
        )
