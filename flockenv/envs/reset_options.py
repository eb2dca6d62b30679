"""Options of a reset: their names, their refusals, and the values for each flock."""

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

    "episodes" does not match "episode_s", though, because its s is a unit.

    Parameters
    ----------
    names
        The names.
    without_unit
        Those names that are recognized without their unit, too.
    """

    def __init__(self, names: Iterable[str], without_unit: Iterable[str] = ()) -> None:
        self._bare = {"".join(_parts_without_unit(name)): name for name in without_unit}
        self._names: dict[str, str] = {}
        for name in names:
            joined, bare = "".join(_parts(name)), "".join(_parts_without_unit(name))
            if joined != f"{bare}s" or len(bare) <= 2:
                self._names[joined] = name
            self._names["_".join(_parts(name))] = name

    def meant(self, name: object) -> str | None:
        """Return the option that a name spells in another way; None if it spells none."""
        parts = _parts(name)
        known = self._names.get("_".join(parts)) or self._names.get("".join(parts))
        return known or self._bare.get("".join(_parts_without_unit(name)))


def _parts(name: object) -> list[str]:
    return re.findall(r"[a-z0-9]+", str(name).casefold())


def _parts_without_unit(name: object) -> list[str]:
    return [part for part in _parts(name) if part not in _UNITS]


def reset_requests(
    options: object,
    flocks: int,
    *,
    lists_flocks: bool = True,
    takes: tuple[str, ...] = RESET_OPTIONS,
) -> list[dict[str, Any]]:
    """Return the request for each flock's reset.

    Other keys may be meant for a wrapper: Gymnasium passes one dictionary through all wrappers.
    Raises ParameterError for keys that would be ignored silently: other spellings of the options,
    arguments of the constructor, and keys of ``state``.

    Parameters
    ----------
    options
        The user's dictionary, or None.
    flocks
        Number of flocks.
    lists_flocks
        Whether a list has an entry for each flock; otherwise the whole list is one value.
    takes
        Names of the options that are accepted.
    """
    if options is None:
        return [{} for _ in range(flocks)]
    if not isinstance(options, Mapping):
        raise TypeError(f"reset options must be a dictionary, not {type(options).__name__}")
    for name in options:
        if name not in takes:
            _refuse_misplaced(name, takes)
    requests: list[dict[str, Any]] = [{} for _ in range(flocks)]
    for name in (option for option in RESET_OPTIONS if option in options):
        for request, value in zip(
            requests, _values(name, options[name], flocks, lists_flocks), strict=True
        ):
            request[name] = as_bytes(value, name) if name == "snapshot" else value
    return requests


def _values(name: str, value: object, flocks: int, lists_flocks: bool) -> Sequence[object]:
    """Return the value of an option for each flock."""
    values = materialized(value)
    is_list = isinstance(value, list) or (isinstance(value, np.ndarray) and value.ndim > 0)
    if not lists_flocks:
        # For one flock, a list is a range of noises, or a target for each leader.
        return [tuple(values) if is_list else values]
    if values is value and not is_list:
        return [value] * flocks
    if len(values) != flocks:
        raise ParameterError(f"reset option {name!r} lists {len(values)} values, expected {flocks}")
    return list(values)


def _refuse_misplaced(name: object, takes: tuple[str, ...]) -> None:
    if (meant := _OF_RESET.meant(name)) in takes:
        raise ParameterError(f"{name!r} is not a reset option: did you mean {meant!r}?")
    meant = meant or _MISPLACED.meant(name)
    if meant is None:
        return
    if meant in _KEYS_OF_STATE:
        words = f"{meant!r} is a key of 'state': options={{'state': {{'pose': ..., ...}}}}"
    elif meant == "seed":
        words = "the seed is an argument of its own"
    elif meant == "reset_mask":
        words = "only a vector environment of Gymnasium takes 'reset_mask'"
    else:
        words = f"{meant!r} is fixed when an environment is made: make another one to change it"
    options = f"{', '.join(takes[:-1])} and {takes[-1]}"
    raise ParameterError(f"{name!r} is not a reset option (these are {options}): {words}")


_OF_RESET = Spellings((*RESET_OPTIONS, "reset_mask"), RESET_OPTIONS)
_MISPLACED = Spellings((*NAMES, *ARGUMENTS, *_KEYS_OF_STATE))
