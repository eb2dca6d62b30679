"""Options of the environments: one flat set of names, checked once, for all interfaces."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

from flockenv import _core
from flockenv.envs.observation import BLOCKS
from flockenv.envs.reward import TERMS
from flockenv.errors import ParameterError, UnknownOptionError, hint, nearest, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.rendering.frames import DEFAULT_SIZE

__all__ = ["RESET_OPTIONS", "EnvOptions"]

#: What ``reset(options=...)`` understands, besides ``reset_mask`` in the vector environment.
RESET_OPTIONS = ("target", "bw_s", "state", "snapshot")

_FIELDS = tuple(each.name for each in fields(FlockParameters))
_SETTINGS = tuple(name for name in _core.env_defaults() if name not in ("bw_s", "autoreset_mode"))
_NAMES = (
    "preset",
    "params",
    "physics",
    "decision_period_cycles",
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

    @classmethod
    def parse(cls, options: Mapping[str, Any]) -> Self:
        """Return options from keyword arguments.

        Raises
        ------
        UnknownOptionError
            For unknown names, with the nearest known one.
        ParameterError
            For values out of range.
        """
        for name in options:
            if name not in _NAMES:
                # TorchRL looks for these words.
                raise UnknownOptionError(
                    f"got an unexpected keyword argument {name!r}, which is no option of the "
                    f"environment: {hint(name, _NAMES)}"
                )
        given = dict(options)
        settings = {name: given.pop(name) for name in _SETTINGS if name in given}
        if isinstance(given.get("bw_s"), tuple | list):
            settings["bw_s"] = tuple(given.pop("bw_s"))
        for name, known in (("observation", BLOCKS), ("reward", TERMS)):
            if isinstance(settings.get(name), Mapping):
                settings[name] = dict(settings[name])
                refuse_unknown(settings[name], known, f"part of {name}")
        if isinstance(settings.get("action_mode"), str):
            refuse_unknown((settings["action_mode"],), _core.ACTION_MODES, "action mode")
        target = settings.get("target")
        if isinstance(target, list | tuple):
            # What is no direction is refused with the settings, where it could be expected.
            if all(each in ("cw", "ccw") for each in target):
                given["target"] = target
        elif isinstance(target, str) and target in ("cw", "ccw"):
            given["target"] = target
        stepping = _physics(given)
        cycles = given.pop("decision_period_cycles", None)
        parameters = _parameters({**given, **stepping})
        if cycles is not None:
            settings["decision_period_s"] = _period_of_cycles(cycles, settings, parameters)
        settings.setdefault("target", parameters.target)
        return cls(parameters, settings)


def _physics(given: dict[str, Any]) -> dict[str, Any]:
    """Take the choice of physics out of the options, and return the fields that it sets."""
    name = given.pop("physics", "default")
    chosen = _core.physics_fields(name)
    for field in chosen:
        if field in given:
            raise ParameterError(f"physics = {name!r} and {field} are both given: one of them")
    return chosen


def _period_of_cycles(
    cycles: float, settings: Mapping[str, Any], parameters: FlockParameters
) -> float:
    """Return the decision period in s nearest to a number of motor cycles."""
    # What is no range is refused with the settings.
    ends = settings.get("bw_s") or (parameters.bw_s,)
    for given, other in (
        (settings.get("decision_period_s") is not None, "decision_period_s"),
        (any(each != ends[0] for each in ends), "a drawn bw_s"),
    ):
        if given:
            raise ParameterError(
                f"decision_period_cycles = {cycles!r} is not accepted with {other}: one of them"
            )
    parameters = parameters.replace(bw_s=ends[0])
    control_hz = settings.get("control_hz", _core.env_defaults()["control_hz"])
    return _core.decision_period_of_cycles(cycles, parameters, control_hz)


def _parameters(given: dict[str, Any]) -> FlockParameters:
    params, preset = given.pop("params", None), given.pop("preset", None)
    if params is None:
        name = "simulation" if preset is None else preset
        return FlockParameters.from_dict({"preset": name, **_DEFAULTS, **given})
    if preset is not None:
        raise ParameterError("params and preset are both given: one of them names the parameters")
    if isinstance(params, Mapping):
        return FlockParameters.from_dict({**params, **given})
    if not isinstance(params, FlockParameters):
        raise TypeError(f"params must be FlockParameters, not {type(params).__name__}")
    return params.replace(**given)


def known_reset_options(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the reset options that are ours.

    Others may be meant for a wrapper and are left alone, unless they look like ours misspelt.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise TypeError(f"reset options must be a dictionary, not {type(options).__name__}")
    for name in options:
        near = nearest(name, (*RESET_OPTIONS, "reset_mask"), cutoff=0.7)
        if near and name != near:
            raise ParameterError(f"{name!r} is no reset option: did you mean {near!r}?")
    return {name: options[name] for name in RESET_OPTIONS if name in options}


def arguments_table() -> str:
    """Return the options as a Markdown table: what the core declares, and how Python adds to it."""
    parameters = FlockParameters().replace(**_DEFAULTS).to_dict()
    declared = {each.name: str(each.metadata["doc"]) for each in fields(FlockParameters)}
    meanings = {
        "preset": "named parameters of the flock, see `FlockParameters.presets`",
        "params": "parameters of the flock, `FlockParameters` or a dictionary, instead of a preset",
        "physics": '"training" steps the flock by dt_s = 0.1 s with one relinearization, coarser '
        'and cheaper; "default" as the parameters have it',
        "n_boats": declared["n_boats"],
        "n_leaders": declared["n_leaders"],
        "bw_s": f"{declared['bw_s']} In s; a pair (low, high) draws it uniformly for each episode.",
        **{name: text for name, *_, text in _core.OPTIONS if name in _SETTINGS},
        "decision_period_cycles": "decision_period_s as a number of motor cycles, rounded to whole "
        "control steps; not where bw_s is drawn",
        "render_mode": 'None, "rgb_array" (`render` returns a frame) or, for environments with one '
        'flock, "human" (a window, extra `render`)',
        "render_size": "width and height of a frame in pixels, 64 to 4096",
    }
    defaults = {
        **parameters,
        **_core.env_defaults(),
        "preset": "simulation",
        "physics": "default",
        "target": parameters["target"],
        "bw_s": parameters["bw_s"],
        "render_size": DEFAULT_SIZE,
    }
    lines = ["| option | default | meaning |", "| --- | --- | --- |"]
    for name, meaning in meanings.items():
        lines.append(f"| `{name}` | `{defaults.get(name)!r}` | {meaning} |")
    lines.append("| any other field of `FlockParameters` | the preset's | see there |")
    return "\n".join(lines)
