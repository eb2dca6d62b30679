"""A check that the compiled simulator fits the sources beside it, in a clone."""

import re
from pathlib import Path

from flockenv import _core

_HERE = Path(__file__).parent
_DECLARED = re.compile(r"^(?:class (\w+)|( {4})?def (\w+)|(\w+): )", re.MULTILINE)


def check() -> None:
    """Raise an ImportError if the core lacks a name that the stubs beside it declare.

    When the sources of a clone change, its core stays the one that was compiled last.
    """
    if not (_HERE.parent / "Cargo.toml").exists():
        return
    if missing := _missing((_HERE / "_core.pyi").read_text(encoding="utf-8")):
        raise ImportError(
            f"{_core.__file__} was compiled from older sources than those beside it: it has no "
            f"{missing}. Run `make build` in {_HERE.parent}"
        )


def _missing(stubs: str) -> str | None:
    """Return the first name of the stubs that the core lacks."""
    owner: object = _core
    for of_class, is_method, function, constant in _DECLARED.findall(stubs):
        owner = getattr(_core, of_class, None) if of_class else owner if is_method else _core
        name: str = of_class or function or constant
        if not name.startswith("_") and not hasattr(_core if of_class else owner, name):
            return name
    return None
