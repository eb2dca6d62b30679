"""A check that the compiled simulator fits the sources beside it, in a clone."""

import re
from pathlib import Path

from flockenv import _core

_PACKAGE = Path(__file__).parent
_DECLARATION = re.compile(r"^(?:class (\w+)|( {4})?def (\w+)|(\w+): )", re.MULTILINE)


def check() -> None:
    """Raise an ImportError if the core lacks a name that the stubs beside it declare.

    In a clone the core may have been compiled from older sources. An installed package is not
    checked.
    """
    if not (_PACKAGE.parent / "Cargo.toml").exists():
        return
    if missing := _missing((_PACKAGE / "_core.pyi").read_text(encoding="utf-8")):
        raise ImportError(
            f"{_core.__file__} was compiled from older sources than those beside it: it has no "
            f"{missing}. Run `make build` in {_PACKAGE.parent}"
        )


def _missing(stubs: str) -> str | None:
    """Return the first name of the stubs that the core lacks."""
    owner: object = _core
    for class_name, is_method, function, constant in _DECLARATION.findall(stubs):
        name: str = class_name or function or constant
        if not is_method:
            owner = _core
        if not name.startswith("_") and not hasattr(owner, name):
            return name
        if class_name:
            owner = getattr(_core, class_name, None)
    return None
