"""Options of a reset: their names, the errors for misplaced ones, and the values of each flock."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from flockenv._io.arguments import as_bytes, materialized
from flockenv.envs.options import ARGUMENTS, NAMES
from flockenv.errors import ParameterError

#: Options of ``reset(options=...)``, besides ``reset_mask`` in the vector environment.
RESET_OPTIONS = ("target", "bw_s", "state", "snapshot", "noise_seed")

#: Options that can be set for all future episodes.
UPCOMING_OPTIONS = ("bw_s", "target")

_KEYS_OF_STATE = ("pose", "velocity", "time_s", "allow_overlap")
_UNITS = {"s", "sec", "cm", "rad", "hz", "per", "seconds"}


class Spellings:
    """Names that are recognized in any case, with other separators, or without separators.

    "episodes" does not match "episode_s", because the s of "episode_s" is a unit.

    Parameters
    ----------
    names
        The names.
    without_unit
        The names that are also recognized without their unit.
    """

    def __init__(self, names: Iterable[str], without_unit: Iterable[str] = ()) -> None:
        self._names_without_unit = {_joined_without_unit(name): name for name in without_unit}
        self._names: dict[str, str] = {}
        for name in names:
            joined, bare = "".join(_parts(name)), _joined_without_unit(name)
            looks_like_plural = joined == f"{bare}s" and len(bare) > 2
            if not looks_like_plural:
                self._names[joined] = name
            self._names["_".join(_parts(name))] = name

    def meant(self, name: object) -> str | None:
        """Return the known name that `name` spells, exactly or in another way; None if none."""
        parts = _parts(name)
        known = self._names.get("_".join(parts)) or self._names.get("".join(parts))
        return known or self._names_without_unit.get(_joined_without_unit(name))


def _parts(name: object) -> list[str]:
    """Return the words and numbers of a name, in lower case."""
    return re.findall(r"[a-z0-9]+", str(name).casefold())


def _joined_without_unit(name: object) -> str:
    return "".join(part for part in _parts(name) if part not in _UNITS)


def reset_requests(
    options: object,
    flocks: int,
    *,
    lists_flocks: bool = True,
    accepted: tuple[str, ...] = RESET_OPTIONS,
) -> list[dict[str, Any]]:
    """Return the options of each flock's reset.

    Unknown keys are ignored, because they may be meant for a wrapper: Gymnasium passes one
    dictionary through all wrappers. Raises ParameterError for keys that are meant for the
    environment but misplaced: other spellings of the options, arguments of the constructor, and
    keys of ``state``.

    Parameters
    ----------
    options
        The user's dictionary, or None.
    flocks
        Number of flocks.
    lists_flocks
        Whether a list has one value per flock; if not, the whole list is a value.
    accepted
        Names of the options that are accepted.
    """
    if options is None:
        return [{} for _ in range(flocks)]
    if not isinstance(options, Mapping):
        raise TypeError(f"reset options must be a dictionary, not {type(options).__name__}")
    for name in options:
        if name not in accepted:
            _refuse_misplaced(name, accepted)
    requests: list[dict[str, Any]] = [{} for _ in range(flocks)]
    for name in (option for option in RESET_OPTIONS if option in options):
        values = _values_of_flocks(name, options[name], flocks, lists_flocks)
        for request, value in zip(requests, values, strict=True):
            request[name] = as_bytes(value, name) if name == "snapshot" else value
    return requests


def _values_of_flocks(
    name: str, value: object, flocks: int, lists_flocks: bool
) -> Sequence[object]:
    """Return the value of an option for each flock."""
    values = materialized(value)
    is_list = isinstance(value, list) or (isinstance(value, np.ndarray) and value.ndim > 0)
    if not lists_flocks:
        # For one flock, a list is a range of noises, or a target for each leader.
        return [tuple(values) if is_list else values]
    is_iterator = values is not value
    if not (is_iterator or is_list):
        return [value] * flocks
    if len(values) != flocks:
        raise ParameterError(f"reset option {name!r} lists {len(values)} values, expected {flocks}")
    return list(values)


def _refuse_misplaced(name: object, accepted: tuple[str, ...]) -> None:
    """Refuse a key that spells an option, an argument of the constructor, or a key of a state."""
    if (meant := _OF_RESET.meant(name)) in accepted:
        raise ParameterError(f"{name!r} is not a reset option: did you mean {meant!r}?")
    meant = meant or _MISPLACED.meant(name)
    if meant is None:
        return
    if meant in _KEYS_OF_STATE:
        advice = f"{meant!r} is a key of 'state': options={{'state': {{'pose': ..., ...}}}}"
    elif meant == "seed":
        advice = "the seed is an argument of its own"
    elif meant == "reset_mask":
        advice = "only a vector environment of Gymnasium takes 'reset_mask'"
    else:
        advice = f"{meant!r} is fixed when an environment is made: make another one to change it"
    options = f"{', '.join(accepted[:-1])} and {accepted[-1]}"
    raise ParameterError(f"{name!r} is not a reset option (these are {options}): {advice}")


_OF_RESET = Spellings((*RESET_OPTIONS, "reset_mask"), RESET_OPTIONS)
_MISPLACED = Spellings((*NAMES, *ARGUMENTS, *_KEYS_OF_STATE))
