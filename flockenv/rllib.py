"""A module for RLlib in which all leaders share one network, for the vector environment.

Needs the extra ``ray`` and torch.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from flockenv._io.extras import require

require("ray.rllib", "ray")
require("torch", "train")

# ruff: noqa: E402 - after the check above
import gymnasium
import torch
from ray.rllib.core.columns import Columns
from ray.rllib.core.rl_module.apis.value_function_api import ValueFunctionAPI
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.rllib.core.rl_module.torch import TorchRLModule

from flockenv.envs.spaces import ObservationSpace
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.policies import NetworkPolicy

_DEFAULTS = {"hidden": (64, 64), "activation": "tanh", "first_log_std": -1.0}
_LAYERS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}


class LeadersModule(TorchRLModule, ValueFunctionAPI):
    """RLlib's module for ``flockenv/Leaders-v0``: each leader's action from its own observation.

    RLlib steps many environments at once only if each has one agent. The agent of
    `LeadersVectorEnv` observes and steers all leaders. This module splits that observation by
    leader, so that all leaders share one network. The value is of the whole observation. The module
    is for PPO and other algorithms with a value function, and for continuous actions.

    ``RLModuleSpec(LeadersModule, model_config={"hidden": (64, 64)})``

    ``model_config`` may hold ``hidden`` (sizes of the hidden layers of both networks),
    ``activation`` ("tanh" or "relu") and ``first_log_std`` (the logarithm of the standard deviation
    of actions at the start; it is learned, and shared by all leaders).
    Raises ParameterError for unknown entries of ``model_config`` and for spaces of other
    environments.
    """

    def setup(self) -> None:
        """Make the networks."""
        model_config = dict(self.model_config or {})
        # RLlib adds entries for its own networks.
        rllib_entries = {option.name for option in fields(DefaultModelConfig)}
        refuse_unknown(model_config.keys() - rllib_entries, _DEFAULTS, "entry of model_config")
        config = {**_DEFAULTS, **model_config}
        refuse_unknown((config["activation"],), _LAYERS, "activation")
        space, actions = self.observation_space, self.action_space
        if not isinstance(space, ObservationSpace) or not isinstance(actions, gymnasium.spaces.Box):
            raise ParameterError(
                f"the spaces {short_repr(space)} and {short_repr(actions)} are not accepted: take "
                "flockenv/Leaders-v0 with continuous actions"
            )
        self.leaders = space.leaders
        size = space.shape[0]
        self.mean = _network(size // self.leaders, config)
        self.value = _network(size, config)
        self.log_std = torch.nn.Parameter(torch.tensor(float(config["first_log_std"])))

    def _forward(self, batch: Mapping[str, Any], **_: object) -> dict[str, Any]:
        rows = batch[Columns.OBS].unflatten(-1, (self.leaders, -1))
        means = self.mean(rows).squeeze(-1)
        log_stds = self.log_std.expand_as(means)
        return {Columns.ACTION_DIST_INPUTS: torch.cat([means, log_stds], dim=-1)}

    def compute_values(self, batch: Mapping[str, Any], embeddings: object = None) -> torch.Tensor:
        """Return the value of each observation."""
        values: torch.Tensor = self.value(batch[Columns.OBS]).squeeze(-1)
        return values

    def network_policy(self, provenance: Mapping[str, str] | None = None) -> NetworkPolicy:
        """Return the leaders' network as a policy, whose saved file every command reads."""
        space = self.observation_space
        return NetworkPolicy.from_module(self.mean, space, provenance=provenance)


def _network(inputs: int, config: Mapping[str, Any]) -> torch.nn.Sequential:
    """Return a network with one output and the hidden layers of the configuration."""
    layers: list[torch.nn.Module] = []
    for size in config["hidden"]:
        layers += [torch.nn.Linear(inputs, size), _LAYERS[config["activation"]]()]
        inputs = size
    return torch.nn.Sequential(*layers, torch.nn.Linear(inputs, 1))
