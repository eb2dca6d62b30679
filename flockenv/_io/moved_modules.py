"""Modules and arguments by the names they had until 0.1: they warn and answer for one version."""

import functools
import importlib
import sys
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

__all__ = ["MOVED", "keep_old_names", "renamed_argument", "renamed_attribute"]

_P = ParamSpec("_P")
_R = TypeVar("_R")

MOVED = {
    "alternation": "runs.protocols.target_switching",
    "analysis": "statistics.intervals",
    "arrangement": "statistics.structure",
    "block_bootstrap": "statistics.block_bootstrap",
    "comparison_report": "comparison.report",
    "contacts": "flock",
    "dwelling": "statistics.dwell_times",
    "engines": "runs.executors",
    "extras": "_io.extras",
    "loops": "runs.protocols.hysteresis",
    "observation": "envs.observation",
    "options": "envs.options",
    "order_parameters": "flock",
    "parallel_env": "envs.parallel",
    "policies.loading": "policies.pretrained",
    "policies.plain": "policies.constant",
    "policies.shipped": "policies.pretrained",
    "prepared_start": "runs.protocols.initial_state",
    "reward": "envs.reward",
    "run_store": "runs.store",
    "seeds": "runs.seeds",
    "single_env": "envs.single",
    "sweep": "runs.sweep",
    "sweep_spec": "runs.sweep_spec",
    "vector_env": "envs.vector",
}
"""Old names below `flockenv`, and where their contents are now."""

RENAMED = {"Dwelling": "DwellTimes", "dwelling": "dwell_times", "summarise": "summarize"}
"""Old names in moved modules, and what they are called now."""


class _MovedModule:
    """Stands in `sys.modules` for a module that has moved."""

    def __init__(self, old: str, new: str) -> None:
        self.__name__, self._new = old, new

    def __getattr__(self, name: str) -> Any:
        # Who walks through sys.modules asks for such names, and means nothing by it.
        if name.startswith("__"):
            raise AttributeError(name)
        value = getattr(importlib.import_module(self._new), RENAMED.get(name, name))
        warnings.warn(f"{self.__name__} has moved to {self._new}", DeprecationWarning, stacklevel=2)
        return value


def keep_old_names(package: str) -> dict[str, Any]:
    """Let a package's moved modules be imported by their old names; return them by name."""
    for old, new in MOVED.items():
        name = f"{package}.{old}"
        sys.modules[name] = _MovedModule(name, f"{package}.{new}")  # type: ignore[assignment]
    return {old: sys.modules[f"{package}.{old}"] for old in MOVED if "." not in old}


def renamed_argument(old: str, new: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Let a function's argument be given by its old name."""

    def renamed(function: Callable[_P, _R]) -> Callable[_P, _R]:
        @functools.wraps(function)
        def call(*arguments: _P.args, **named: _P.kwargs) -> _R:
            if old in named:
                words = f"the argument {old} is called {new}"
                warnings.warn(words, DeprecationWarning, stacklevel=2)
                named[new] = named.pop(old)
            return function(*arguments, **named)

        return call

    return renamed


def renamed_attribute(old: str, new: str) -> property:
    """Return the property that answers by an attribute's old name."""

    def value(owner: Any) -> Any:
        words = f"the attribute {old} is called {new}"
        warnings.warn(words, DeprecationWarning, stacklevel=2)
        return getattr(owner, new)

    return property(value)
