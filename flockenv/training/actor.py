"""From a torch actor to a `NetworkPolicy` and back."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeGuard

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.policies import NetworkPolicy
from flockenv.policies.base import check_action_mode
from flockenv.policies.encoders import LeaningEncoder
from flockenv.training.settings import TrainingSettings

require("torch", "train")
require("stable_baselines3", "train")

import torch  # noqa: E402 - after the check above
from stable_baselines3.common.policies import ActorCriticPolicy  # noqa: E402

from flockenv.sb3 import LeaderVecEnv, LeaningExtractor, usual_features  # noqa: E402
from flockenv.sb3.encoders import EXTRACTORS, EncoderExtractor  # noqa: E402

__all__ = [
    "actor_module",
    "copy_into_actor",
    "encoder_module",
    "encoder_options",
    "measure_features",
    "network_policy",
    "one_thread",
]

#: Flocks of each pool in which features are measured, at most.
_MEASURED_FLOCKS = 64


def actor_module(policy: ActorCriticPolicy) -> torch.nn.Sequential:
    """Return the encoder, if there is one, the hidden layers and the last layer of an actor."""
    encoder = getattr(policy.mlp_extractor, "encoder", None)
    parts = [policy.mlp_extractor.policy_net, policy.action_net]
    return torch.nn.Sequential(*parts if encoder is None else (encoder, *parts))


def _parts(actor: torch.nn.Module) -> tuple[EncoderExtractor | None, list[torch.nn.Linear]]:
    """Return the encoder and the layers of an actor, or of an average of one."""
    modules = list((actor_module(actor) if _is_policy(actor) else actor).modules())
    encoder = next((each for each in modules if isinstance(each, EncoderExtractor)), None)
    inner = set() if encoder is None else set(encoder.modules())
    layers = [each for each in modules if isinstance(each, torch.nn.Linear) and each not in inner]
    return encoder, layers


def _is_policy(actor: torch.nn.Module) -> TypeGuard[ActorCriticPolicy]:
    return isinstance(actor, ActorCriticPolicy)


def encoder_options(settings: TrainingSettings) -> dict[str, Any]:
    """Return the options of the settings' encoder, apart from numbers that are measured."""
    if settings.encoder == "deepsets":
        return {"layers": settings.encoder_arch, "activation": settings.activation}
    return {}


def encoder_module(settings: TrainingSettings, space: Any) -> EncoderExtractor | None:
    """Return the settings' encoder for a space of observations, with its first numbers."""
    if settings.encoder == "none":
        return None
    encoder = EXTRACTORS[settings.encoder](space, **encoder_options(settings))
    measure_features(encoder, settings)
    return encoder


def measure_features(encoder: torch.nn.Module | None, settings: TrainingSettings) -> None:
    """Give an encoder of features their usual values in the flocks of the settings."""
    if not isinstance(encoder, LeaningExtractor):
        return
    venvs = []
    for pool in settings.pools:
        options = {**settings.environment(pool), "action_mode": "lean"}
        flocks = min(settings.num_flocks, _MEASURED_FLOCKS)
        venvs.append(LeaderVecEnv(flocks, n_leaders=list(settings.n_leaders), **options))
        venvs[-1].seed(settings.flock_seeds(1)[0])
    usual = usual_features(*venvs)
    found = LeaningEncoder(usual["mean"], usual["deviation"], observation=settings.observation)
    encoder.copy_from(found)


def network_policy(
    actor: torch.nn.Module, settings: TrainingSettings, provenance: Mapping[str, str]
) -> NetworkPolicy:
    """Return the mean of an actor as a policy that needs no torch.

    Parameters
    ----------
    actor
        A policy of stable-baselines3, its `actor_module` or an average of that.
    settings
        What it is trained with.
    provenance
        As of `NetworkPolicy`.

    Raises
    ------
    ParameterError
        If weights are not finite.
    """
    encoder, modules = _parts(actor)
    layers = [
        (layer.weight.detach().cpu().numpy().T, layer.bias.detach().cpu().numpy())
        for layer in modules
    ]
    weights, biases = zip(*layers, strict=True)
    return NetworkPolicy(
        weights,
        biases,
        settings.activation,
        observation=settings.observation,
        mirror_to_target=settings.mirror_to_target,
        encoder=None if encoder is None else encoder.encoder(),
        squashed=settings.squash,
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
        If layers, encoder, activation or layout are not those of the settings.
    """
    check_action_mode(start, settings.decisions["action_mode"], "to start this training from")
    hidden = tuple(len(bias) for bias in start.biases[:-1])
    encoder, layers = _parts(policy)
    for name, own, wanted in (
        ("encoder", "none" if start.encoder is None else start.encoder.kind, settings.encoder),
        ("squash", start.squashed, settings.squash),
        ("net_arch", hidden, settings.net_arch),
        ("activation", start.activation, settings.activation),
        ("observation", start.observation, dict(settings.observation)),
        ("mirror_to_target", start.mirror_to_target, settings.mirror_to_target),
    ):
        if own != wanted:
            raise ParameterError(
                f"{name} = {wanted!r} is not accepted: the policy to start from has {own!r}"
            )
    if encoder is not None and start.encoder is not None:
        encoder.copy_from(start.encoder)
    with torch.no_grad():
        for layer, weight, bias in zip(layers, start.weights, start.biases, strict=True):
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
