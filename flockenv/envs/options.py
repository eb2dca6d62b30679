"""Options of the environments: one flat set of names, checked once, for all interfaces."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, NamedTuple, Self

from numpy.typing import ArrayLike

from flockenv import _core
from flockenv._io.arguments import once
from flockenv.errors import (
    ParameterError,
    UnknownOptionError,
    hint,
    nearest,
)
from flockenv.parameters import FlockParameters

TERMS: dict[str, str] = dict(_core.REWARD_TERMS)
"""Name and meaning of each term of the reward; every term is larger for better."""


class Option(NamedTuple):
    """An option of the environments: its default, and what it means."""

    default: Any
    doc: str


OPTIONS: dict[str, Option] = {
    "preset": Option("simulation", "named parameters of the flock: `FlockParameters.presets()`"),
    "params": Option(
        None, "parameters of the flock, `FlockParameters` or a dictionary, instead of a preset"
    ),
    "physics": Option(
        "default",
        '"training" steps the flock by dt_s = 0.1 s with one relinearization, coarser and cheaper; '
        '"default" as the parameters have it',
    ),
    **{each["name"]: Option(each["default"], each["doc"]) for each in _core.OPTIONS},
    "bw_s": Option(
        {each.name: each.default for each in fields(FlockParameters)}["bw_s"],
        "duration of the backward phase in s, the source of disorder; a pair (low, high) draws it "
        "uniformly for each episode",
    ),
    "render_mode": Option(
        None,
        'None, "rgb_array" (`render` returns a frame) or, for environments with one flock, "human" '
        "(a window, extra `render`)",
    ),
    "render_size": Option((600, 600), "width and height of a frame in pixels, 64 to 4096"),
}
"""The options of the environments by name, besides the fields of `FlockParameters`."""

#: What ``reset(options=...)`` understands, besides ``reset_mask`` in the vector environment.
RESET_OPTIONS = ("target", "bw_s", "state", "snapshot", "noise_seed")

#: What may hold for all episodes that are to come.
UPCOMING_OPTIONS = ("bw_s", "target")

_FIELDS = tuple(each.name for each in fields(FlockParameters))
_SETTINGS = tuple(
    each["name"] for each in _core.OPTIONS if each["name"] not in ("bw_s", "autoreset_mode")
)
_NAMES = (
    "preset",
    "params",
    "physics",
    *_FIELDS,
    *(name for name in _SETTINGS if name not in _FIELDS),
)
#: Where neither ``params`` nor these fields are given: the paper's 27 boats, three of them leaders.
_DEFAULTS = {"n_boats": 27, "n_leaders": 3}


@dataclass(frozen=True)
class EnvOptions:
    """Checked options: the flock's parameters and the settings of the environment."""

    parameters: FlockParameters
    settings: dict[str, Any]
    #: A function of the environment, instead of the core's rewards.
    own_reward: Callable[[Any], ArrayLike] | None = None

    @classmethod
    def parse(cls, options: Mapping[str, Any], *, takes_function: bool = False) -> Self:
        """Return options from keyword arguments, whose reward may be a function where that is so.

        Unknown names are an `UnknownOptionError` with the nearest known one.
        """
        for name in options:
            if name not in _NAMES:
                # TorchRL looks for these words.
                raise UnknownOptionError(
                    f"got an unexpected keyword argument {name!r}, which is no option of the "
                    f"environment: {hint(name, _NAMES)}"
                )
        given, own_reward = {name: once(value) for name, value in options.items()}, None
        reward = given.get("reward")
        if takes_function and callable(reward):
            own_reward, given["reward"] = reward, {}
        settings = {name: given.pop(name) for name in _SETTINGS if name in given}
        if isinstance(given.get("bw_s"), tuple | list):
            settings["bw_s"] = tuple(given.pop("bw_s"))
        for name in ("observation", "reward"):
            if name in settings:
                settings[name] = _plain(settings[name])
        target = settings.get("target")
        if isinstance(target, list | tuple):
            # What is no direction is refused with the settings, where it could be expected.
            if all(each in ("cw", "ccw") for each in target):
                given["target"] = target
        elif isinstance(target, str) and target in ("cw", "ccw"):
            given["target"] = target
        stepping = _physics(given)
        parameters = _parameters({**given, **stepping})
        settings.setdefault("target", parameters.target)
        return cls(parameters, settings, own_reward)


def _plain(value: Any) -> Any:
    """Return a mapping, or each of a list, as the dictionary that the core reads."""
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return dict(value) if isinstance(value, Mapping) else value


def _physics(given: dict[str, Any]) -> dict[str, Any]:
    """Take the choice of physics out of the options, and return the fields that it sets."""
    name = given.pop("physics", "default")
    chosen = _core.physics_fields(name)
    for field in chosen:
        if field in given:
            raise ParameterError(f"physics = {name!r} and {field} are both given: give one")
    return chosen


def _parameters(given: dict[str, Any]) -> FlockParameters:
    params, preset = given.pop("params", None), given.pop("preset", None)
    if params is None:
        name = "simulation" if preset is None else preset
        return FlockParameters.from_dict({"preset": name, **_DEFAULTS, **given})
    if preset is not None:
        raise ParameterError("params and preset are both given: give one")
    if isinstance(params, Mapping):
        return FlockParameters.from_dict({**params, **given})
    if not isinstance(params, FlockParameters):
        raise TypeError(f"params must be FlockParameters, not {type(params).__name__}")
    return params.replace(**given)


def known_reset_options(
    options: Mapping[str, Any] | None, takes: tuple[str, ...] = RESET_OPTIONS
) -> dict[str, Any]:
    """Return the reset options that are ours.

    Others may be meant for a wrapper and are left alone, unless they are options of the environment
    itself, or look like one of either.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise TypeError(f"reset options must be a dictionary, not {type(options).__name__}")
    for name in options:
        if name not in takes:
            _refuse_reset_option(name, takes)
    return {name: options[name] for name in RESET_OPTIONS if name in options}


_UNITS = {"s", "sec", "cm", "rad", "hz", "per", "seconds"}
# Arguments of functions, which some take for options.
_ARGUMENTS = ("seed", "render_mode", "render_size", "autoreset_mode", "num_envs", "num_flocks")


def _bare(name: object) -> tuple[str, str]:
    """Return a name in lower case, letters and digits alone, without its unit and with it."""
    parts = re.split(r"[^a-z0-9]+", str(name).casefold())
    return "".join(part for part in parts if part not in _UNITS), "".join(parts)


def _meant(name: object, known: Iterable[str]) -> str | None:
    """Return the known name that another one stands for, None where it may be anything else."""
    by_bare = {bare: each for each in known for bare in _bare(each)}
    near = [nearest(bare, by_bare, cutoff=0.8) for bare in _bare(name)]
    return next((by_bare[each] for each in near if each), None)


def _refuse_reset_option(name: object, takes: tuple[str, ...]) -> None:
    others = [each for each in (*_NAMES, *_ARGUMENTS, "reset_mask") if each not in takes]
    options = f"{', '.join(takes[:-1])} and {takes[-1]}"
    if name not in others and (near := _meant(name, takes)):
        raise ParameterError(f"{name!r} is no reset option: did you mean {near!r}?")
    if (near := _meant(name, others)) is None:
        return
    if near == "seed":
        words = "the seed is an argument of its own"
    elif near == "reset_mask":
        words = "only a vector environment of Gymnasium takes 'reset_mask'"
    else:
        words = f"{near!r} is fixed when an environment is made: make another one to change it"
    raise ParameterError(f"{name!r} is no reset option (these are {options}): {words}")


class FixedOptions:
    """An environment whose options are no attributes: to set one is an error, not without effect.

    Names in other case or without their unit are refused too. What a constructor keeps under the
    name of an argument is set there, once.
    """

    _kept: ClassVar[tuple[str, ...]] = ()
    _next_episode: ClassVar[str] = "reset(options={...})"

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute; an AttributeError says what sets an option instead."""
        if name not in self._kept or vars(self).get(name, value) is not value:
            refuse_attribute(name, self._next_episode)
        super().__setattr__(name, value)


_ARGUMENTS_OF_RESET = (*RESET_OPTIONS, "seed", "reset_mask")
_FIXED = (*_NAMES, *_ARGUMENTS, "parameters", "num_leaders")
_BARE = {
    bare: name for name in (*_FIXED, *_ARGUMENTS_OF_RESET) for bare in _bare(name) if len(bare) > 1
}


def refuse_attribute(name: str, next_episode: str) -> None:
    """Refuse to set an attribute that is named like an option or another argument.

    `next_episode` is the call that sets options of an episode.
    """
    near = () if name.startswith("_") else _bare(name)
    meant = next((_BARE[each] for each in near if each in _BARE), None)
    if meant is None:
        return
    if meant == "seed":
        words = "it is given to a reset"
    elif meant in _ARGUMENTS_OF_RESET:
        words = f"{next_episode} sets {meant!r} for an episode"
    else:
        words = "it is fixed when an environment is made: make another one to change it"
    raise AttributeError(f"{name!r} cannot be set as an attribute: {words}")
