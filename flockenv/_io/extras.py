"""Optional packages, imported where they are used, with an error that says what to install."""

import importlib
from types import ModuleType

from flockenv.errors import FlockError

IS_PUBLISHED = False
"""Whether ``pip install flockenv`` gets this package: until the first release anybody may have the
name. The release sets it, and a test then asks every page to say the same."""


class MissingExtraError(FlockError, ImportError):
    """An optional package is missing; the message names the extra that installs it."""


def install(extra: str) -> str:
    """Return a sentence that says how to install an extra."""
    if IS_PUBLISHED:
        return f"pip install 'flockenv[{extra}]'"
    return f"pip install '.[{extra}]' in a clone of flockenv, 'FILE.whl[{extra}]' with its wheel"


def require(module: str, extra: str) -> ModuleType:
    """Import a module of an optional extra; a MissingExtraError says how to install it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package = module.partition(".")[0]
        raise MissingExtraError(f"{package} is not installed: {install(extra)}") from error
