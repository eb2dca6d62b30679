"""Environments by id, for ``gymnasium.make`` and ``gymnasium.make_vec``."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any

from flockenv.envs.ids import ENVIRONMENTS

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

ENTRY_POINT = "flockenv.envs.single:LeadersEnv"


def registered(is_ours: Callable[[Mapping[str, Any]], bool]) -> "EnvSpec | None":
    """Return the first registered environment of leaders whose options are ours, if any is."""
    import gymnasium

    specs = (each for each in gymnasium.registry.values() if each.entry_point == ENTRY_POINT)
    return next((each for each in specs if is_ours(each.kwargs)), None)


def register() -> None:
    """Make the environments known to Gymnasium, once: now, or as soon as it is imported.

    Gymnasium takes half as long to import as NumPy, and has no entry points for packages.
    """
    if "gymnasium" in sys.modules:
        _register()
    else:
        sys.meta_path.insert(0, _Gymnasium())


def _register() -> None:
    import gymnasium

    for env_id, each in ENVIRONMENTS.items():
        if env_id not in gymnasium.registry:
            gymnasium.register(
                id=env_id,
                entry_point=ENTRY_POINT,
                vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
                kwargs=dict(each.options),
                # It refuses a step before a reset itself, and options as attributes, which wrappers
                # would take.
                order_enforce=False,
                disable_env_checker=True,
            )


class _Gymnasium:
    """Finds Gymnasium where the others do, and registers the environments once it is executed."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != "gymnasium":
            return None
        others = (each for each in sys.meta_path if not isinstance(each, _Gymnasium))
        spec = next(filter(None, (each.find_spec(name, path, target) for each in others)), None)
        if spec is None or spec.loader is None:
            return spec
        execute = spec.loader.exec_module

        def execute_and_register(module: ModuleType) -> None:
            execute(module)
            _register()

        spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
