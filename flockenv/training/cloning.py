"""Behavior cloning: a network that steers as a law does, for training to start from."""

import time
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from flockenv._io.provenance import provenance_of
from flockenv.envs.observation import BLOCKS, observation_space
from flockenv.errors import ParameterError
from flockenv.policies import ModelPolicy, NetworkPolicy, load
from flockenv.policies.base import RowPolicy, check_action_mode
from flockenv.policies.laws import LAWS
from flockenv.sb3.encoders import ACTIVATION_MODULES
from flockenv.training.actor import encoder_module, network_policy, one_thread
from flockenv.training.pools import PooledVecEnv
from flockenv.training.settings import TrainingError, TrainingSettings

__all__ = ["clone_law", "initial_policy"]


def initial_policy(settings: TrainingSettings, command: str, trust: bool) -> NetworkPolicy | None:
    """Return the network that a run starts from: the one given, a clone of a law, or None.

    Raises
    ------
    ParameterError
        For a start that is no law and no policy's file, and for other numbers of leaders.
    """
    if not settings.start:
        return None
    found: RowPolicy | ModelPolicy
    if settings.start in LAWS:
        found = LAWS[settings.start](
            observation=settings.observation, mirror_to_target=settings.mirror_to_target
        )
    else:
        try:
            found = load(settings.start, trust=trust)
        except OSError as error:
            raise ParameterError(
                f"start = {settings.start!r} is neither {' nor '.join(LAWS)}, and as a policy's "
                f"file it cannot be read: {error.strerror}"
            ) from error
    if isinstance(found, NetworkPolicy):
        return found
    if isinstance(found, ModelPolicy):
        for leaders in settings.n_leaders:
            found.check_leaders(leaders)
    return clone_law(found, settings, command=command)


def clone_law(
    law: RowPolicy | ModelPolicy,
    settings: TrainingSettings,
    *,
    samples: int = 100_000,
    epochs: int = 20,
    command: str = "",
) -> NetworkPolicy:
    """Fit a network to a law's rudders in the states that it visits, somewhat disturbed.

    Parameters
    ----------
    law
        Any policy of rows, such as a closed-form law, with the layout of the settings.
    settings
        Where the leaders steer, the network's shape, and the seed.
    samples
        Observations to learn from; a tenth of them is held out.
    epochs
        Passes through them.
    command
        Provenance, stored in ``made``.

    Returns
    -------
    NetworkPolicy
        ``provenance["clone_rms"]`` is its root mean square difference from the law where held out.

    Raises
    ------
    ParameterError
        If the law's layout is not that of the settings.
    TrainingError
        If the loss is not finite.
    """
    own = ({**BLOCKS, **law.observation}, law.mirror_to_target)
    wanted = ({**BLOCKS, **settings.observation}, settings.mirror_to_target)
    if own != wanted:
        raise ParameterError(f"the law's layout is {own!r}, that of the settings {wanted!r}")
    check_action_mode(law, settings.decisions["action_mode"], "to clone for this training")
    start = time.perf_counter()
    generator = torch.Generator().manual_seed(settings.seed)
    rows, rudders = _visited(law, settings, samples)
    order = torch.randperm(len(rows), generator=generator).numpy()
    held_out, seen = np.split(order, [len(rows) // 10])
    with one_thread():
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(settings.seed)
            network = _network(settings)
        _fit(network, rows[seen], rudders[seen], epochs, generator)
    provenance = provenance_of(
        command, seed=settings.seed, samples=len(rows), wall_s=time.perf_counter() - start
    )
    policy = network_policy(network, settings, {**provenance, "cloned": repr(law)})
    error = policy.predict(rows[held_out])[0][:, 0] - rudders[held_out]
    policy.provenance["clone_rms"] = f"{np.sqrt(np.mean(error**2)):.4f}"
    return policy


def _visited(
    law: RowPolicy | ModelPolicy, settings: TrainingSettings, samples: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    env = PooledVecEnv(settings.replace(critic="observation", squash=False))
    random = np.random.default_rng(settings.seed)
    observations: Any = env.reset()
    rows, rudders = [], []
    disturbance = np.zeros((env.num_envs, 1))
    for _ in range(-(-samples // env.num_envs)):
        steered, _ = law.predict(observations)
        rows.append(observations)
        rudders.append(steered[:, 0])
        # Slowly varying, or it would cancel out before a boat has turned.
        disturbance = 0.95 * disturbance + 0.15 * random.standard_normal(disturbance.shape)
        observations, _, _, _ = env.step(np.clip(steered + disturbance, -1.0, 1.0))
    return np.concatenate(rows), np.concatenate(rudders)


def _network(settings: TrainingSettings) -> torch.nn.Sequential:
    space = observation_space(settings.observation, mirror_to_target=settings.mirror_to_target)
    encoder = encoder_module(settings, space)
    modules: list[torch.nn.Module] = [] if encoder is None else [encoder]
    inputs = space.shape[0] if encoder is None else encoder.features_dim
    for outputs in settings.net_arch:
        modules += [torch.nn.Linear(inputs, outputs), ACTIVATION_MODULES[settings.activation]()]
        inputs = outputs
    modules.append(torch.nn.Linear(inputs, 1))
    if settings.squash:
        modules.append(torch.nn.Tanh())
    return torch.nn.Sequential(*modules)


def _fit(
    network: torch.nn.Sequential,
    rows: NDArray[np.float32],
    rudders: NDArray[np.float32],
    epochs: int,
    generator: torch.Generator,
) -> None:
    inputs, targets = torch.from_numpy(rows), torch.from_numpy(rudders)
    optimizer = torch.optim.Adam(network.parameters(), lr=3e-3)
    batches = max(1, len(inputs) // 128)
    steps = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs * batches)
    for _ in range(epochs):
        for batch in torch.randperm(len(inputs), generator=generator).chunk(batches):
            error = network(inputs[batch])[:, 0] - targets[batch]
            # The rudder is clipped: beyond the end of its range any output is right.
            beyond = (targets[batch].abs() >= 1.0) & (error * targets[batch] > 0.0)
            loss = error.masked_fill(beyond, 0.0).square().mean()
            if not torch.isfinite(loss):
                raise TrainingError("cloning: the loss is not finite")
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            steps.step()
