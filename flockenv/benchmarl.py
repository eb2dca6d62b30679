"""Tasks for BenchMARL: many flocks through TorchRL, and the policies that its learners train.

Needs the extra ``benchmarl``. ``python -m flockenv.benchmarl
task=flockenv/lean algorithm=mappo`` is BenchMARL's own command with these tasks.
"""

import copy
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from flockenv._io.extras import require

require("benchmarl", "benchmarl")

# ruff: noqa: E402 - after the check above
import torch
from benchmarl.environments import task_config_registry
from benchmarl.environments.common import Task, TaskClass
from benchmarl.experiment import Experiment
from benchmarl.models import Mlp
from benchmarl.utils import _read_yaml_config
from tensordict.nn import ProbabilisticTensorDictModule
from torchrl.data import Composite
from torchrl.envs import EnvBase
from torchrl.modules import TanhDelta, TanhNormal

from flockenv.envs.options import EnvOptions
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.policies import NetworkPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.torchrl import GROUP, STATES, LeadersEnv

CONF = Path(__file__).parent / "benchmarl_tasks"
"""The folder in which Hydra searches configurations: ``task/flockenv/NAME.yaml``."""

_ENV_NAME = "flockenv"


class LeadersTaskClass(TaskClass):
    """A task for BenchMARL: flocks in which all leaders are one group of agents.

    Parameters
    ----------
    name
        Name of the task.
    config
        ``state``, as for `flockenv.torchrl.LeadersEnv`, and options of the environments. With
        ``rudder_levels`` the task also has discrete actions, for learners that need them.

    Raises
    ------
    ParameterError
        For unknown options and values out of range.
    """

    def __init__(self, name: str, config: dict[str, Any] | None) -> None:
        super().__init__(name, config)
        options = {key: value for key, value in self.config.items() if key != "state"}
        refuse_unknown((self.config.get("state", "none"),), STATES, "state")
        EnvOptions.parse(options)  # Only for its errors.

    def get_env_fun(
        self,
        num_envs: int,
        continuous_actions: bool,
        seed: int | None,
        device: torch.device | str,
    ) -> Callable[[], EnvBase]:
        """Return a function that makes the environment with `num_envs` flocks.

        The flocks get the training seeds of the run whose number is `seed`; see
        `flockenv.runs.seeds.POLICY_SEEDS`.
        """
        options = {"state": "none", **copy.deepcopy(self.config)}
        if continuous_actions:
            options.pop("rudder_levels", None)
        first_seed = None if seed is None else POLICY_SEEDS["training"].seeds(1, run=seed)[0]

        def make() -> EnvBase:
            env = LeadersEnv(num_envs, device=device, **options)
            env.set_seed(first_seed)
            return env

        return make

    def supports_continuous_actions(self) -> bool:
        """Return True: actions are rudders, leans or headings."""
        return True

    def supports_discrete_actions(self) -> bool:
        """Return whether the configuration has ``rudder_levels``."""
        return self.config.get("rudder_levels") is not None

    def max_steps(self, env: EnvBase) -> int:
        """Return the decisions of an episode."""
        steps: int = env.episode_steps
        return steps

    def has_render(self, env: EnvBase) -> bool:
        """Return False: there are no frames; ``flockenv replay`` plays recordings."""
        return False

    def group_map(self, env: EnvBase) -> dict[str, list[str]]:
        """Return the agents' names by group; all leaders of a flock are one group."""
        groups: dict[str, list[str]] = env.group_map
        return groups

    def observation_spec(self, env: EnvBase) -> Composite:
        """Return the spec of each leader's observation."""
        return Composite({GROUP: env.observation_spec_unbatched[GROUP]})

    def state_spec(self, env: EnvBase) -> Composite | None:
        """Return the spec of the flock's state, or None without a state in the configuration."""
        if self.config.get("state", "none") == "none":
            return None
        return Composite({"state": env.observation_spec_unbatched["state"]})

    def action_spec(self, env: EnvBase) -> Composite:
        """Return the spec of each leader's action."""
        return env.full_action_spec_unbatched

    def info_spec(self, env: EnvBase) -> Composite | None:
        """Return None: there are no infos."""
        return None

    def action_mask_spec(self, env: EnvBase) -> Composite | None:
        """Return None: every action is allowed."""
        return None

    @staticmethod
    def env_name() -> str:
        """Return the name of the environment, which is also the folder of its configurations."""
        return _ENV_NAME


class LeadersTask(Task):
    """The tasks: LEADERS, the paper's 27 boats, and LEAN, nine boats whose leaders lean."""

    LEADERS = None
    LEAN = None

    @staticmethod
    def associated_class() -> type[LeadersTaskClass]:
        """Return the class of every task."""
        return LeadersTaskClass

    def get_from_yaml(self, path: str | None = None) -> LeadersTaskClass:
        """Return the task with the configuration of a file, by default the task's own in `CONF`."""
        default_path = CONF / "task" / _ENV_NAME / f"{self.name.lower()}.yaml"
        config = _read_yaml_config(str(default_path if path is None else path))
        task: LeadersTaskClass = self.get_task(config)
        return task


# By this, BenchMARL finds the tasks by name: ``flockenv/leaders`` and so on.
task_config_registry.update(
    {f"{_ENV_NAME}/{name.lower()}": task for name, task in LeadersTask.__members__.items()}
)


def network_policy(
    experiment: Experiment, provenance: Mapping[str, str] | None = None
) -> NetworkPolicy:
    """Return the policy of an experiment's leaders; every command reads the file that it saves.

    Parameters
    ----------
    experiment
        An experiment of a `LeadersTask` whose policy is BenchMARL's MLP, shared by all leaders. The
        critic may be any.
    provenance
        As for `NetworkPolicy`.

    Raises
    ------
    ParameterError
        For another environment or another kind of policy. A graph network, for example, takes the
        observations of other leaders, but a leader's policy here takes only its own.
    """
    env = experiment.test_env.base_env
    if not isinstance(env, LeadersEnv):
        raise ParameterError(
            f"an experiment with {type(env).__name__} is not accepted: LeadersTask"
        )
    if env.rudder_levels is not None:
        raise ParameterError(
            f"rudder_levels = {env.rudder_levels} is not accepted here: a policy's file holds a "
            "network whose output is a rudder or an angle"
        )
    actor = experiment.algorithm.get_policy_for_loss(GROUP)
    networks = [module for module in actor.modules() if isinstance(module, Mlp)]
    is_shared = experiment.config.share_policy_params or env.num_leaders == 1
    if len(networks) != 1 or not is_shared:
        raise ParameterError(
            "this policy is not accepted: one MLP that all leaders share (model_config = "
            "MlpConfig, share_policy_params)"
        )
    network = copy.deepcopy(networks[0].mlp.get_stateful_net())
    if not experiment.config.share_policy_params:
        # The parameters have a first dimension of agents, of which there is one.
        for parameter in network.parameters():
            parameter.data = parameter.data[0]
    drawn = [part for part in actor.modules() if isinstance(part, ProbabilisticTensorDictModule)]
    # The last parameters are the outputs' biases: of the mean, or of the mean and the spread.
    n_outputs = [*network.parameters()][-1].shape[-1]
    return NetworkPolicy.from_module(
        network,
        env.observation_space,
        squashed=any(module.distribution_class in (TanhDelta, TanhNormal) for module in drawn),
        has_spread=n_outputs == 2,
        provenance=provenance,
    )


if __name__ == "__main__":
    from benchmarl.run import hydra_experiment

    sys.argv.append(f"hydra.searchpath=[file://{CONF}]")
    hydra_experiment()
