"""What the settings of a training may be, one by one."""

from collections.abc import Mapping
from typing import Any

from flockenv.errors import ParameterError, shown
from flockenv.policies.encoders import ACTIVATIONS, ENCODERS

__all__ = ["accepted"]

_MAY_BE_EMPTY = ("net_arch", "critic_arch")
_CHOICES: Mapping[str, tuple[str, ...]] = {
    "target": ("random", "cw", "ccw", "alternate"),
    "activation": tuple(ACTIVATIONS),
    "critic": ("observation", "flock"),
    "encoder": ("none", *ENCODERS),
    "device": ("auto", "cpu", "cuda"),
}
#: Lowest and highest number; numbers of a list each.
_RANGES: Mapping[str, tuple[float, float]] = {
    "n_boats": (2, 10_000),
    "n_leaders": (1, 10_000),
    "noise": (0.0, 100.0),
    "episode_s": (0.1, 1e6),
    "control_hz": (0.1, 1000.0),
    "samples": (1, 1e15),
    "flock_hours": (1e-6, 1e9),
    "num_flocks": (1, 1_000_000),
    "n_steps": (2, 1_000_000),
    "batch_size": (2, 1e9),
    "n_epochs": (1, 10_000),
    "learning_rate": (0.0, 1.0),
    "final_learning_rate": (0.0, 1.0),
    "gamma": (0.0, 1.0),
    "gae_lambda": (0.0, 1.0),
    "clip_range": (1e-6, 10.0),
    "ent_coef": (-1.0, 10.0),
    "vf_coef": (0.0, 100.0),
    "max_grad_norm": (1e-9, 1e9),
    "target_kl": (0.0, 100.0),
    "net_arch": (1, 4096),
    "critic_arch": (1, 4096),
    "encoder_arch": (1, 4096),
    "average": (1e-6, 1.0),
    "log_std_init": (-20.0, 5.0),
    "sde_sample_freq": (-1, 1_000_000),
    "shared_noise_s": (0.0, 1e6),
    "seed": (0, (1 << 32) - 1),
    "checkpoint_every": (1, 1e15),
    "validate_every": (1, 1e15),
    "validate_from": (0.0, 1.0),
    "validation_episodes": (2, 100_000),
    "validation_s": (1.0, 1e6),
    "validation_hz": (0.1, 1000.0),
}


def accepted(name: str, value: Any, example: Any) -> Any:
    """Return a setting's value as it is stored.

    Parameters
    ----------
    name
        The setting's name.
    value
        What was given.
    example
        A value of the setting's kind: its default, where there is one.

    Raises
    ------
    ParameterError
        For a value of another kind or out of range.
    """
    if isinstance(example, tuple):
        return _accepted_list(name, value, example)
    if name in _RANGES:
        return _accepted_number(name, value, whole=isinstance(example, int))
    if isinstance(example, bool) and not isinstance(value, bool):
        raise ParameterError(f"{name} = {shown(value)} is not accepted: true or false")
    if isinstance(example, str) and not isinstance(value, str):
        raise ParameterError(f"{name} = {shown(value)} is not accepted: a text")
    if name in _CHOICES and value not in _CHOICES[name]:
        raise ParameterError(
            f"{name} = {shown(value)} is not accepted: {', '.join(_CHOICES[name])}"
        )
    if name in ("observation", "reward", "options"):
        if not isinstance(value, Mapping):
            raise ParameterError(f"{name} = {shown(value)} is not accepted: a table")
        return dict(value)
    return value


def _accepted_list(name: str, value: Any, example: tuple[Any, ...]) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple) or (not value and name not in _MAY_BE_EMPTY):
        raise ParameterError(f"{name} = {shown(value)} is not accepted: a list")
    if name == "noise" and len(value) != 2:
        raise ParameterError(f"noise = {shown(value)} is not accepted: (lowest, highest)")
    if name == "pools":
        return tuple(str(pool) for pool in value)
    return tuple(_accepted_number(name, each, whole=isinstance(example[0], int)) for each in value)


def _accepted_number(name: str, value: Any, whole: bool) -> Any:
    low, high = _RANGES[name]
    kinds = int if whole else int | float
    if isinstance(value, bool) or not isinstance(value, kinds) or not low <= value <= high:
        kind = "a whole number" if whole else "a number"
        raise ParameterError(
            f"{name} = {shown(value)} is not accepted: {kind} in [{low:g}, {high:g}]"
        )
    return value if whole else float(value)
