"""What can be reproduced, by name. To add to it: a module with `REPRODUCTIONS`, and a line here."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from flockenv._io.extras import require
from flockenv.errors import ParameterError, nearest

if TYPE_CHECKING:
    from flockenv.reproduce.reproduction import Reproduction

__all__ = ["ALL", "BUDGETED", "load", "names", "require_packages", "resolve"]

ALL = "all"
"""The name that stands for everything of the paper."""

# Modules are loaded when a name is given: they need the extra `plot`.
_PAPER: Mapping[str, str] = {
    **dict.fromkeys(("fig4", "table2"), "flockenv.reproduce.experiment.state_figures"),
    **dict.fromkeys(("fig5", "fig6", "fig7"), "flockenv.reproduce.experiment.time_figures"),
    "fig8": "flockenv.reproduce.experiment.leader_figures",
    **dict.fromkeys(("fig9", "fig10", "fig11"), "flockenv.reproduce.experiment.noise_figures"),
    "fig12": "flockenv.reproduce.experiment.leader_figures",
    "motion": "flockenv.reproduce.experiment.motion_figures",
    **dict.fromkeys(("fig14", "fig15", "fig16", "fig17"), "flockenv.reproduce.simulation.figures"),
    "scheme-and-noise": "flockenv.reproduce.simulation.table",
}
_BEYOND: Mapping[str, str] = {
    "transition-order": "flockenv.reproduce.transition.order",
    "leader-fraction": "flockenv.reproduce.leader_fraction.fraction",
    "conflicting-targets": "flockenv.reproduce.conflicting_targets.conflict",
}
BUDGETED = tuple(_BEYOND)
"""Names beyond the paper, whose runs follow from a budget of computing time."""


def names() -> list[str]:
    """Return all names there are, but for `ALL`."""
    return [*_PAPER, *_BEYOND]


def resolve(given: Iterable[str]) -> list[str]:
    """Return names in the catalogue's order, each once, `ALL` replaced by those of the paper.

    Raises
    ------
    ParameterError
        For an unknown name; the message lists those there are.
    """
    given = list(given)
    for name in given:
        if name != ALL and name not in names():
            near = nearest(name, [*names(), ALL])
            meant = f"did you mean {near!r}? " if near else ""
            raise ParameterError(
                f"{name!r} cannot be reproduced: {meant}there are {', '.join(names())}, "
                f"and {ALL!r} for all of the paper"
            )
    return [name for name in names() if name in given or (ALL in given and name in _PAPER)]


def require_packages() -> None:
    """Check that the packages are there that figures and their tables need.

    Raises
    ------
    MissingExtraError
        Without the extra ``plot``.
    """
    for package in ("pandas", "pyarrow", "scipy", "matplotlib"):
        require(package, "plot")


def load(name: str) -> "Reproduction":
    """Return what a name of the catalogue stands for.

    Raises
    ------
    MissingExtraError
        Without the extra ``plot``.
    """
    require_packages()
    module = require({**_PAPER, **_BEYOND}[name], "plot")
    found: Reproduction = next(each for each in module.REPRODUCTIONS if each.name == name)
    return found
