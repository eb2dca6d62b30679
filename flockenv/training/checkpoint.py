"""Checkpoints: the complete state of training, so that a killed run resumes bit for bit.

They are plain arrays in an ``.npz`` file, so that loading one executes nothing; stable-baselines3's
own ``.zip`` files hold pickles and are never read.
"""

import json
import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from flockenv._io.array_file import write_arrays
from flockenv._io.npz_header import array_of, entry_of, read_headed
from flockenv.envs.observation import observation_version
from flockenv.errors import ParameterError
from flockenv.sb3.shared_noise import HeldNoise
from flockenv.training.learner import Learner
from flockenv.training.pools import PooledVecEnv
from flockenv.training.settings import TrainingSettings
from flockenv.training.validation import validation_names

__all__ = ["Progress", "State", "read_settings", "restore", "save", "state_of"]

FORMAT = "flockenv checkpoint 1"
LEARNED = ("loss", "approx_kl", "clip_fraction", "explained_variance")
CURVE = ("samples", "reward", "signed_order", *LEARNED)
"""Columns of the curve, one row per rollout; the learned ones are of its update."""
_ADAM = ("step", "exp_avg", "exp_avg_sq")

State = dict[str, NDArray[Any]]
"""A checkpoint's arrays by name."""


@dataclass
class Progress:
    """How far a run is: what started it, samples, seconds, and what was measured on the way."""

    command: str = ""
    samples: int = 0
    wall_s: float = 0.0
    best_score: float | None = None
    curve: list[dict[str, float]] = field(default_factory=list)
    validations: list[dict[str, float]] = field(default_factory=list)


def state_of(model: Learner, settings: TrainingSettings, progress: Progress) -> State:
    """Return the contents of a checkpoint; later training does not change them."""
    env = model.env
    assert isinstance(env, PooledVecEnv)
    header = {
        "format": FORMAT,
        "observation_version": observation_version(settings.observation),
        "settings": settings.to_dict(),
        "progress": asdict(progress),
        "updates": model._n_updates,
    }
    arrays: State = {"header": np.array(json.dumps(header))}
    for name, tensor in model.policy.state_dict().items():
        arrays[f"parameter:{name}"] = tensor.cpu().numpy().copy()
    for place, slot in model.policy.optimizer.state_dict()["state"].items():
        for name, tensor in slot.items():
            arrays[f"optimizer:{place}:{name}"] = tensor.cpu().numpy().copy()
    for place, state in enumerate(env.get_state()):
        arrays[f"environment:{place}"] = np.frombuffer(state, np.uint8)
    arrays |= _exploration(model) | _average(model)
    assert model._last_episode_starts is not None
    arrays["episode_starts"] = model._last_episode_starts.copy()
    return arrays | _random_states()


def save(path: str | os.PathLike[str], state: State) -> None:
    """Write a checkpoint, whole or not at all.

    Raises
    ------
    OSError
        If it cannot be written; the one that was there before is still there.
    """
    write_arrays(path, state, compressed=True)


def read_settings(path: str | os.PathLike[str]) -> TrainingSettings:
    """Return the settings of a checkpoint's run; see `restore` for the errors."""
    header, _ = read_headed(path, "checkpoint", FORMAT)
    with _reported(path):
        return _settings(header)


def restore(path: str | os.PathLike[str], model: Learner) -> Progress:
    """Put a model, its environment and the sources of chance where a checkpoint left them.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no checkpoint, is damaged, or was made with other settings, or for another version
        of the observation.
    """
    header, arrays = read_headed(path, "checkpoint", FORMAT)
    env = model.env
    assert isinstance(env, PooledVecEnv)
    with _reported(path):
        progress = _checked_progress(header, _settings(header))
        updates = _count("updates", header.get("updates"))
        for name, like in _blank(model).items():
            _check(array_of(arrays, name, like.shape), name, like)
        places = range(len(env.parts))
        flocks = [array_of(arrays, f"environment:{place}").tobytes() for place in places]
        model._last_obs = env.set_state(flocks)
        model._last_episode_starts = arrays["episode_starts"]
        policy, optimizer = model.policy, model.policy.optimizer
        parameters = {name: torch.from_numpy(a) for name, a in _named(arrays, "parameter").items()}
        policy.load_state_dict(parameters)
        slots = {
            place: {name: torch.from_numpy(arrays[f"optimizer:{place}:{name}"]) for name in _ADAM}
            for place in _trained(model)
        }
        groups = optimizer.state_dict()["param_groups"]
        optimizer.load_state_dict({"state": slots, "param_groups": groups})
        if model.averaged is not None:
            averaged = _named(arrays, "average")
            model.averaged.load_state_dict({n: torch.from_numpy(a) for n, a in averaged.items()})
        noise = _held_noise(model)
        if noise is not None:
            noise.set_state(_named(arrays, "exploration"))
        model.num_timesteps, model._n_updates = progress.samples, updates
        _restore_random_states(arrays)
    return progress


@contextmanager
def _reported(path: str | os.PathLike[str]) -> Iterator[None]:
    try:
        yield
    except (KeyError, TypeError, ValueError, OverflowError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise ParameterError(f"{path} is no whole checkpoint: {reason}") from error


def _settings(header: dict[str, Any]) -> TrainingSettings:
    return TrainingSettings.from_dict(entry_of(header, "settings", dict))


def _checked_progress(header: dict[str, Any], settings: TrainingSettings) -> Progress:
    stored, names = entry_of(header, "progress", dict), [each.name for each in fields(Progress)]
    if sorted(stored) != sorted(names):
        raise ParameterError(f"progress has {', '.join(stored)}: not {', '.join(names)}")
    entry_of(stored, "command", str)
    _count("samples", stored["samples"])
    if not _is_number(stored["wall_s"]) or not 0 <= stored["wall_s"] < math.inf:
        raise ParameterError(f"wall_s = {stored['wall_s']!r} is not accepted: a number of seconds")
    columns = {"curve": CURVE, "validations": ("samples", "mean", *validation_names(settings))}
    for name, wanted in columns.items():
        rows = stored[name]
        if not isinstance(rows, list) or not all(_is_row(row, wanted) for row in rows):
            raise ParameterError(f"{name} is not accepted: rows of numbers, {', '.join(wanted)}")
    best = stored["best_score"]
    fits = _is_number(best) and math.isfinite(best) if stored["validations"] else best is None
    if not fits:
        raise ParameterError(f"best_score = {best!r} is not accepted: the best of the validations")
    return Progress(**stored)


def _count(name: str, value: Any) -> int:
    if type(value) is not int or not 0 <= value < 1 << 53:
        raise ParameterError(f"{name} = {value!r} is not accepted: a whole number of at least 0")
    return value


def _is_number(value: Any) -> bool:
    return type(value) is float or (type(value) is int and abs(value) < 1 << 53)


def _is_row(row: Any, wanted: Sequence[str]) -> bool:
    return (
        isinstance(row, dict)
        and sorted(row) == sorted(wanted)
        and all(_is_number(value) for value in row.values())
    )


def _blank(model: Learner) -> State:
    """Arrays of the shapes and types that a checkpoint of this model has, but for its flocks."""
    blank: State = {"episode_starts": np.zeros(model.n_envs, np.bool_)}
    for name, tensor in model.policy.state_dict().items():
        blank[f"parameter:{name}"] = tensor.cpu().numpy()
    for place, tensor in _trained(model).items():
        shapes = {"step": (), "exp_avg": tensor.shape, "exp_avg_sq": tensor.shape}
        for name in _ADAM:
            blank[f"optimizer:{place}:{name}"] = np.zeros(shapes[name], np.float32)
    blank |= _exploration(model) | _average(model)
    states = _random_states()
    return blank | {name: states[name] for name in ("numpy_keys", "numpy_rest", "torch_random")}


def _exploration(model: Learner) -> State:
    """Return what a noise that is held over the end of a rollout leaves to the next one."""
    noise = _held_noise(model)
    if noise is None:
        return {}
    return {f"exploration:{name}": array for name, array in noise.get_state().items()}


def _held_noise(model: Learner) -> HeldNoise | None:
    held = getattr(getattr(model.policy, "action_dist", None), "held", None)
    return held if isinstance(held, HeldNoise) else None


def _average(model: Learner) -> State:
    """Return the moving average of the actor's weights, if there is one."""
    if model.averaged is None:
        return {}
    averaged = model.averaged.state_dict()
    return {f"average:{name}": each.cpu().numpy().copy() for name, each in averaged.items()}


def _trained(model: Learner) -> dict[int, torch.Tensor]:
    """Return what is learned, by its place in the optimizer."""
    groups = model.policy.optimizer.param_groups
    every = (each for group in groups for each in group["params"])
    return {place: each for place, each in enumerate(every) if each.requires_grad}


def _check(array: NDArray[Any], name: str, like: NDArray[Any]) -> None:
    if array.dtype != like.dtype:
        raise ParameterError(f"{name} holds {array.dtype}, which is not accepted: {like.dtype}")
    if not np.isfinite(array).all():
        raise ParameterError(f"{name} holds numbers that are not finite")


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
    keys, (place, has_gauss, gauss) = arrays["numpy_keys"], arrays["numpy_rest"].tolist()
    # NumPy would take any place, and read beyond its keys.
    if place not in range(len(keys) + 1) or has_gauss not in (0, 1):
        raise ParameterError(f"numpy_rest = {[place, has_gauss, gauss]} is not accepted")
    np.random.set_state(("MT19937", keys, int(place), int(has_gauss), gauss))  # noqa: NPY002
    torch.set_rng_state(torch.from_numpy(arrays["torch_random"]))
    on_gpu = _named(arrays, "cuda_random")
    if torch.cuda.is_available() and on_gpu:
        states = [torch.from_numpy(on_gpu[str(place)]) for place in range(len(on_gpu))]
        torch.cuda.set_rng_state_all(states[: torch.cuda.device_count()])
