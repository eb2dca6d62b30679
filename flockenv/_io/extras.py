"""Optional packages, imported where they are used, with an error that says what to install."""

import importlib
from typing import Any

from flockenv.errors import FlockError


class MissingExtraError(FlockError, ImportError):
    """An optional package is not installed; the message names the extra that brings it."""


def require(module: str, extra: str) -> Any:
    """Import a module of an optional extra; a MissingExtraError says how to install it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package = module.partition(".")[0]
        raise MissingExtraError(
            f"{package} is not installed: pip install 'flockenv[{extra}]'"
        ) from error
