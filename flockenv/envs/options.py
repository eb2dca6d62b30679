"""Options of the environments: one flat set of names, checked once, for all interfaces."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple, Self

from numpy.typing import ArrayLike

from flockenv import _core
from flockenv._io.arguments import listed
from flockenv.errors import ParameterError, UnknownOptionError, hint, short_repr
from flockenv.parameters import FlockParameters

TERMS: dict[str, str] = dict(_core.REWARD_TERMS)
"""Name and meaning of each term of the reward. Larger is better for every term."""


class Option(NamedTuple):
    """An option of the environments: its default and its meaning."""

    default: Any
    doc: str


OPTIONS: dict[str, Option] = {
    "preset": Option("simulation", "named parameters of the flock: `FlockParameters.presets()`"),
    "params": Option(
        None, "parameters of the flock, `FlockParameters` or a dictionary, instead of a preset"
    ),
    "physics": Option(
        "default",
        '"training" steps the flock by dt_s = 0.1 s with tolerance_cm = 1e-4, coarser and cheaper; '
        '"publication" by 0.01 s with 1e-6, finer; "default" as the parameters have it',
    ),
    **{option["name"]: Option(option["default"], option["doc"]) for option in _core.OPTIONS},
    "bw_s": Option(
        {parameter.name: parameter.default for parameter in fields(FlockParameters)}["bw_s"],
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

_FIELDS = tuple(parameter.name for parameter in fields(FlockParameters))
_SETTINGS = tuple(
    option["name"] for option in _core.OPTIONS if option["name"] not in ("bw_s", "autoreset_mode")
)
NAMES = (
    "preset",
    "params",
    "physics",
    *_FIELDS,
    *(name for name in _SETTINGS if name not in _FIELDS),
)
"""Keyword arguments that every environment takes."""

ARGUMENTS = ("seed", "render_mode", "render_size", "autoreset_mode", "num_envs", "num_flocks")
"""Arguments of constructors and resets that users may mistake for options."""

#: Defaults if neither ``params`` nor these fields are given: the paper's 27 boats, three of them
#: leaders.
_DEFAULTS = {"n_boats": 27, "n_leaders": 3}


@dataclass(frozen=True)
class EnvOptions:
    """Checked options: the flock's parameters and the settings of the environment."""

    parameters: FlockParameters
    settings: dict[str, Any]
    #: A user's function of the environment that replaces the core's rewards.
    own_reward: Callable[[Any], ArrayLike] | None = None

    @classmethod
    def parse(
        cls,
        options: Mapping[str, Any],
        *,
        takes_function: bool = False,
        flocks_argument: str | None = None,
    ) -> Self:
        """Return options from keyword arguments.

        Raises `UnknownOptionError` for unknown names; it suggests the nearest known one.

        Parameters
        ----------
        options
            The user's keyword arguments; arrays become lists.
        takes_function
            Whether the reward may be a function.
        flocks_argument
            Name of the argument that sets the number of flocks; None for one flock.
        """
        _check_names(options, flocks_argument)
        values: dict[str, Any] = {name: listed(value) for name, value in options.items()}
        own_reward = _pop_function(values, takes_function)
        settings = _pop_settings(values)
        stepping = _pop_physics(values)
        parameters = _flock_parameters({**values, **stepping})
        if parameters.n_leaders == 0:
            raise ParameterError(
                "n_leaders = 0 is not accepted: at least 1 in an environment; simulate runs flocks "
                "without leaders"
            )
        settings.setdefault("target", parameters.target)
        return cls(parameters, settings, own_reward)


def _check_names(options: Mapping[str, Any], flocks_argument: str | None) -> None:
    """Refuse unknown names of options."""
    for name in (option for option in options if option not in NAMES):
        # TorchRL searches messages for "unexpected keyword argument".
        raise UnknownOptionError(
            f"got an unexpected keyword argument {name!r}, which is not an option of the "
            f"environment: {_suggestion(name, flocks_argument)}"
        )


def _suggestion(name: str, flocks_argument: str | None) -> str:
    """Return a suggestion for an unknown option."""
    if name in ("max_cycles", "max_steps", "max_episode_steps", "horizon", "time_limit"):
        return "an episode lasts 'episode_s' seconds, with 'control_hz' steps in each"
    if name not in ("num_envs", "num_flocks", "n_envs", "num_workers"):
        return hint(name, NAMES)
    if flocks_argument is None:
        return "this is one flock; gymnasium.make_vec(id, num_envs=...) makes many"
    return f"the number of flocks is {flocks_argument!r} here"


def _pop_function(
    values: dict[str, Any], takes_function: bool
) -> Callable[[Any], ArrayLike] | None:
    """Remove a reward function from the options, and return it; None without one.

    Refuses a function where the environment takes none.
    """
    if not callable(values.get("reward")):
        return None
    function: Callable[[Any], ArrayLike] = values.pop("reward")
    if not takes_function:
        raise ParameterError(
            f"reward = {short_repr(function)} is not accepted: weights by name. "
            "LeadersVectorEnv and LeaderVecEnv also take a function. For a single flock, "
            "compute your own reward in a subclass or a wrapper"
        )
    values["reward"] = {}
    return function


def _pop_settings(values: dict[str, Any]) -> dict[str, Any]:
    """Remove the settings of the environment from the options, and return them.

    A target that is a direction also stays: it is one of the flock's parameters.
    """
    settings = {name: values.pop(name) for name in _SETTINGS if name in values}
    if isinstance(values.get("bw_s"), tuple | list):
        settings["bw_s"] = tuple(values.pop("bw_s"))
    for name in ("observation", "reward"):
        if name in settings:
            settings[name] = _as_dictionaries(settings[name])
    target = settings.get("target")
    targets = target if isinstance(target, list | tuple) else (target,)
    # Other targets, such as "random", are settings alone; the core checks them.
    if targets and all(direction in ("cw", "ccw") for direction in targets):
        values["target"] = target
    return settings


def _as_dictionaries(value: object) -> object:
    """Return a mapping as a dictionary, also those in a list; any other value unchanged."""
    if isinstance(value, list | tuple):
        return [_as_dictionaries(item) for item in value]
    return dict(value) if isinstance(value, Mapping) else value


def _pop_physics(values: dict[str, Any]) -> dict[str, Any]:
    """Remove the choice of physics from the options, and return the fields that it sets."""
    name = values.pop("physics", "default")
    physics_fields = _core.physics_fields(name)
    for field in physics_fields:
        if field in values:
            raise ParameterError(f"physics = {name!r} and {field} are both given: give one")
    return physics_fields


def _flock_parameters(values: dict[str, Any]) -> FlockParameters:
    """Return the parameters of `params` or of a preset, with the other values as changes."""
    params, preset = values.pop("params", None), values.pop("preset", None)
    if params is None:
        name = "simulation" if preset is None else preset
        return FlockParameters.from_dict({"preset": name, **_DEFAULTS, **values})
    if preset is not None:
        raise ParameterError("params and preset are both given: give one")
    if isinstance(params, Mapping):
        return FlockParameters.from_dict({**params, **values})
    if not isinstance(params, FlockParameters):
        raise TypeError(f"params must be FlockParameters, not {type(params).__name__}")
    return params.replace(**values)
