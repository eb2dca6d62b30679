"""One layout of the observation for policies that act on the same flocks."""

from collections.abc import Mapping, Sequence
from typing import Any

from flockenv.envs.observation import BLOCKS
from flockenv.errors import ParameterError, shown

__all__ = ["in_one_layout"]

_DEFAULTS: Mapping[str, Any] = {"observation": {}, "mirror_to_target": False}


def in_one_layout(
    policies: Sequence[Any], options: Mapping[str, Any]
) -> tuple[list[Any], dict[str, Any]]:
    """Return policies that observe the same, and the options of the environment with that layout.

    Policies that can observe another layout, those with a method ``observing``, take over that of
    the others, or that of the options where there is no other.

    Parameters
    ----------
    policies
        One or more.
    options
        Options of the environment, with ``observation`` and ``mirror_to_target`` or without.

    Raises
    ------
    ParameterError
        If the others, or they and the options, differ in their layouts.
    """
    given = {name: options[name] for name in _DEFAULTS if name in options}
    fixed = [each for each in policies if not hasattr(each, "observing")]
    layout = _layout_of(fixed[0]) if fixed else {**_DEFAULTS, **given}
    for other in fixed[1:]:
        if _whole(_layout_of(other)) != _whole(layout):
            raise ParameterError(
                f"{shown(fixed[0])} and {shown(other)} observe different layouts: the ends of a "
                "direction have to observe the same"
            )
    if any(_whole(layout)[name] != value for name, value in _whole(given).items() if name in given):
        raise ParameterError(
            f"{shown(fixed[0])} observes another layout than the environment: leave the options "
            "observation and mirror_to_target to the policy"
        )
    found = [each.observing(**layout) if hasattr(each, "observing") else each for each in policies]
    return found, {**options, **layout}


def _layout_of(policy: Any) -> dict[str, Any]:
    return {name: getattr(policy, name, None) or usual for name, usual in _DEFAULTS.items()}


def _whole(layout: Mapping[str, Any]) -> dict[str, Any]:
    """Return a layout with every block, so that equal ones compare equal."""
    whole = {**_DEFAULTS, **layout}
    return {**whole, "observation": {**BLOCKS, **(whole["observation"] or {})}}
