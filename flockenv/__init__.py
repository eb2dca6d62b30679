"""Flocks of leader-steered rigid boats in a pool, simulated in Rust."""

import importlib
import importlib.util
import os
import sys
from typing import TYPE_CHECKING, Any

from flockenv import _avx2, _built
from flockenv._core import __version__

if TYPE_CHECKING:
    from flockenv import policies
    from flockenv.envs.parallel import LeadersParallelEnv, env, parallel_env
    from flockenv.envs.single import LeadersEnv
    from flockenv.envs.vector import LeadersVectorEnv
    from flockenv.errors import (
        EpisodeError,
        FlockError,
        InUseError,
        ParameterError,
        SolverError,
    )
    from flockenv.flock import Contacts, ContactSeries, Flock, Statistics, StepStatistics
    from flockenv.order import OrderParameters, OrderSeries, order_series
    from flockenv.parameters import FlockParameters
    from flockenv.recording import Recording
    from flockenv.simulation import simulate

__all__ = [
    "ContactSeries",
    "Contacts",
    "EpisodeError",
    "Flock",
    "FlockError",
    "FlockParameters",
    "InUseError",
    "LeadersEnv",
    "LeadersParallelEnv",
    "LeadersVectorEnv",
    "OrderParameters",
    "OrderSeries",
    "ParameterError",
    "Recording",
    "SolverError",
    "Statistics",
    "StepStatistics",
    "__version__",
    "env",
    "order_series",
    "parallel_env",
    "policies",
    "simulate",
]

_NAMES_OF_MODULE = {
    "envs.parallel": ("LeadersParallelEnv", "env", "parallel_env"),
    "envs.single": ("LeadersEnv",),
    "envs.vector": ("LeadersVectorEnv",),
    "errors": ("EpisodeError", "FlockError", "InUseError", "ParameterError", "SolverError"),
    "flock": ("ContactSeries", "Contacts", "Flock", "Statistics", "StepStatistics"),
    "order": ("OrderParameters", "OrderSeries", "order_series"),
    "parameters": ("FlockParameters",),
    "recording": ("Recording",),
    "simulation": ("simulate",),
}

_MAKE_ENV = 'gymnasium.make("flockenv/Leaders-v0")'
_COUNTERPARTS = {
    **dict.fromkeys(("make", "make_env", "Env", "FlockEnv", "LeaderEnv"), _MAKE_ENV),
    "make_vec": 'gymnasium.make_vec("flockenv/Leaders-v0", num_envs=64)',
    "LeaderVecEnv": "flockenv.sb3.LeaderVecEnv",
    "run": "flockenv.simulate",
    "load": "flockenv.Recording.load, or flockenv.policies.load",
}
"""Names that users of other packages may look for, and the names here that have their role."""


def _prints_help_alone() -> bool:
    """Return whether this process is a command line that only prints its help or version."""
    program, *words = getattr(sys, "argv", None) or [""]
    if program == "-m":  # `python -m`: its package is imported before the module has a path.
        program = sys.orig_argv[-len(words) - 1]
    name = os.path.basename(program).removesuffix(".exe")
    return name == "flockenv" and words in ([], ["-h"], ["--help"], ["--version"])


# Check the core, and choose its build, before anything uses it.
_built.check()
_avx2.choose()
# Gymnasium, which has no entry points for packages, and PettingZoo take as long to import as NumPy.
if not _prints_help_alone():
    importlib.import_module("flockenv.envs.registration").register()


def __getattr__(name: str) -> Any:
    # A module is imported when one of its names is first used, so that `import flockenv` is fast.
    for module, names in _NAMES_OF_MODULE.items():
        if name in names:
            value = getattr(importlib.import_module(f"flockenv.{module}"), name)
            break
    else:
        if name.startswith("_") or importlib.util.find_spec(f"flockenv.{name}") is None:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}{_hint(name)}")
        value = importlib.import_module(f"flockenv.{name}")
    globals()[name] = value
    return value


def _hint(name: str) -> str:
    """Return a suggestion for an unknown name, or "" without one."""
    from flockenv.errors import nearest

    if name.startswith("_"):  # Libraries look for private names; they need no suggestion.
        return ""
    near = _COUNTERPARTS.get(name) or nearest(name, __all__)
    return f": did you mean {near}?" if near else ""


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
