"""From a torch actor to a `NetworkPolicy` and back."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.policies import NetworkPolicy
from flockenv.policies.base import check_action_mode
from flockenv.training.settings import TrainingSettings

require("torch", "train")
require("stable_baselines3", "train")

import torch  # noqa: E402 - after the check above
from stable_baselines3.common.policies import ActorCriticPolicy  # noqa: E402

__all__ = ["ACTIVATION_MODULES", "copy_into_actor", "network_policy", "one_thread"]

ACTIVATION_MODULES: Mapping[str, type[torch.nn.Module]] = {
    "tanh": torch.nn.Tanh,
    "relu": torch.nn.ReLU,
}
"""Torch's modules for `flockenv.policies.network.ACTIVATIONS`."""


def _layers(policy: ActorCriticPolicy) -> list[torch.nn.Linear]:
    hidden = policy.mlp_extractor.policy_net
    layers = [*hidden, policy.action_net]
    return [layer for layer in layers if isinstance(layer, torch.nn.Linear)]


def network_policy(
    policy: ActorCriticPolicy, settings: TrainingSettings, provenance: Mapping[str, str]
) -> NetworkPolicy:
    """Return the mean of an actor as a policy that needs no torch.

    Raises
    ------
    ParameterError
        If weights are not finite.
    """
    layers = [
        (layer.weight.detach().cpu().numpy().T, layer.bias.detach().cpu().numpy())
        for layer in _layers(policy)
    ]
    weights, biases = zip(*layers, strict=True)
    return NetworkPolicy(
        weights,
        biases,
        settings.activation,
        observation=settings.observation,
        mirror_to_target=settings.mirror_to_target,
        provenance=provenance,
        **settings.decisions,
    )


def copy_into_actor(
    start: NetworkPolicy, policy: ActorCriticPolicy, settings: TrainingSettings
) -> None:
    """Give an actor the weights of a policy.

    Raises
    ------
    ParameterError
        If hidden layers, activation or layout are not those of the settings.
    """
    check_action_mode(start, settings.decisions["action_mode"], "to start this training from")
    hidden = tuple(len(bias) for bias in start.biases[:-1])
    for name, own, wanted in (
        ("net_arch", hidden, settings.net_arch),
        ("activation", start.activation, settings.activation),
        ("observation", start.observation, dict(settings.observation)),
        ("mirror_to_target", start.mirror_to_target, settings.mirror_to_target),
    ):
        if own != wanted:
            raise ParameterError(
                f"{name} = {wanted!r} is not accepted: the policy to start from has {own!r}"
            )
    with torch.no_grad():
        for layer, weight, bias in zip(_layers(policy), start.weights, start.biases, strict=True):
            layer.weight.copy_(torch.from_numpy(weight.T.copy()))
            layer.bias.copy_(torch.from_numpy(bias))


@contextmanager
def one_thread() -> Iterator[None]:
    """Let torch use one thread: sums differ with their number, and small networks are no faster."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
