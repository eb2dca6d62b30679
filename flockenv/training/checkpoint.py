"""Checkpoints: all that a killed run needs to go on as if nothing had happened.

They are plain arrays in an ``.npz`` file, so that loading one executes nothing; stable-baselines3's
own ``.zip`` files hold pickles and are never read.
"""

import json
import os
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO

from flockenv.array_file import read_arrays, write_arrays
from flockenv.errors import ParameterError
from flockenv.observation import OBSERVATION_VERSION
from flockenv.training.pools import PooledVecEnv
from flockenv.training.settings import TrainingSettings

__all__ = ["Progress", "read_settings", "restore", "save"]

FORMAT = "flockenv checkpoint 1"


@dataclass
class Progress:
    """How far a run is: what began it, samples, seconds, and what was measured on the way."""

    command: str = ""
    samples: int = 0
    wall_s: float = 0.0
    best_score: float | None = None
    curve: list[dict[str, float]] = field(default_factory=list)
    validations: list[dict[str, float]] = field(default_factory=list)


def save(
    path: str | os.PathLike[str], model: PPO, settings: TrainingSettings, progress: Progress
) -> None:
    """Write a checkpoint between two rollouts, whole or not at all.

    Raises
    ------
    OSError
        If it cannot be written; the one that was there before is still there.
    """
    env = model.env
    assert isinstance(env, PooledVecEnv)
    header = {
        "format": FORMAT,
        "observation_version": OBSERVATION_VERSION,
        "settings": settings.to_dict(),
        "progress": asdict(progress),
        "updates": model._n_updates,
    }
    arrays: dict[str, NDArray[Any]] = {"header": np.array(json.dumps(header))}
    for name, tensor in model.policy.state_dict().items():
        arrays[f"parameter:{name}"] = tensor.cpu().numpy()
    for place, slot in model.policy.optimizer.state_dict()["state"].items():
        for name, tensor in slot.items():
            arrays[f"optimizer:{place}:{name}"] = tensor.cpu().numpy()
    for place, state in enumerate(env.get_state()):
        arrays[f"environment:{place}"] = np.frombuffer(state, np.uint8)
    assert model._last_episode_starts is not None
    arrays["episode_starts"] = model._last_episode_starts
    write_arrays(path, arrays | _random_states(), compressed=True)


def read_settings(path: str | os.PathLike[str]) -> TrainingSettings:
    """Return the settings of a checkpoint's run; see `restore` for the errors."""
    header, _ = _read(path)
    return TrainingSettings.from_dict(header["settings"])


def restore(path: str | os.PathLike[str], model: PPO) -> Progress:
    """Put a model, its environment and the sources of chance where a checkpoint left them.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no checkpoint, is damaged, or was made with other settings, or for another version
        of the observation.
    """
    header, arrays = _read(path)
    env = model.env
    assert isinstance(env, PooledVecEnv)
    try:
        progress = Progress(**header["progress"])
        policy, optimizer = model.policy, model.policy.optimizer
        parameters = {name: torch.from_numpy(a) for name, a in _named(arrays, "parameter").items()}
        policy.load_state_dict(parameters)
        slots: dict[int, dict[str, torch.Tensor]] = {}
        for key, array in _named(arrays, "optimizer").items():
            place, _, name = key.partition(":")
            slots.setdefault(int(place), {})[name] = torch.from_numpy(array)
        groups = optimizer.state_dict()["param_groups"]
        optimizer.load_state_dict({"state": slots, "param_groups": groups})
        states = _named(arrays, "environment")
        flocks = [states[str(place)].tobytes() for place in range(len(states))]
        model._last_obs = env.set_state(flocks)
        model._last_episode_starts = arrays["episode_starts"]
        model.num_timesteps, model._n_updates = progress.samples, header["updates"]
        _restore_random_states(arrays)
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise ParameterError(f"{path} is no whole checkpoint: {error}") from error
    return progress


def _read(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    arrays = read_arrays(path)
    try:
        header = json.loads(str(arrays["header"]))
        made_for = header["observation_version"] if header["format"] == FORMAT else None
    except (KeyError, TypeError, ValueError) as error:
        raise ParameterError(f"{path} is no checkpoint: {error!r}") from error
    if made_for is None:
        raise ParameterError(f"{path} is no checkpoint in the format {FORMAT!r}")
    if made_for != OBSERVATION_VERSION:
        raise ParameterError(
            f"{path} was made for version {made_for} of the observation; this is version "
            f"{OBSERVATION_VERSION}: train anew"
        )
    return header, arrays


def _named(arrays: dict[str, NDArray[Any]], kind: str) -> dict[str, NDArray[Any]]:
    start = f"{kind}:"
    return {name[len(start) :]: a for name, a in arrays.items() if name.startswith(start)}


def _random_states() -> dict[str, NDArray[Any]]:
    # PPO shuffles minibatches with NumPy's global generator and draws actions with torch's.
    _, keys, place, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002
    states: dict[str, NDArray[Any]] = {
        "numpy_keys": np.asarray(keys),
        "numpy_rest": np.array([place, has_gauss, gauss], np.float64),
        "torch_random": torch.get_rng_state().numpy(),
    }
    if torch.cuda.is_available():
        for place, state in enumerate(torch.cuda.get_rng_state_all()):
            states[f"cuda_random:{place}"] = state.numpy()
    return states


def _restore_random_states(arrays: dict[str, NDArray[Any]]) -> None:
    place, has_gauss, gauss = arrays["numpy_rest"].tolist()
    state = ("MT19937", arrays["numpy_keys"], int(place), int(has_gauss), gauss)
    np.random.set_state(state)  # noqa: NPY002
    torch.set_rng_state(torch.from_numpy(arrays["torch_random"]))
    on_gpu = _named(arrays, "cuda_random")
    if torch.cuda.is_available() and on_gpu:
        states = [torch.from_numpy(on_gpu[str(place)]) for place in range(len(on_gpu))]
        torch.cuda.set_rng_state_all(states[: torch.cuda.device_count()])
