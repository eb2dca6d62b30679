"""Optional packages, imported where they are used, with an error that says what to install."""

import importlib
from types import ModuleType

from flockenv.errors import FlockError

IS_PUBLISHED = False
"""Whether ``pip install flockenv`` installs this package. Before the first release it may install
somebody else's. The release sets this to True, and a test compares every page with it."""


class MissingExtraError(FlockError, ImportError):
    """An optional package is missing; the message names the extra that installs it."""


def install(extra: str) -> str:
    """Return a text that says how to install an extra."""
    if IS_PUBLISHED:
        return f"pip install 'flockenv[{extra}]'"
    return f"pip install '.[{extra}]' in a clone of flockenv, 'FILE.whl[{extra}]' with its wheel"


def require(module: str, extra: str) -> ModuleType:
    """Import a module of an extra; raise MissingExtraError if a package is not installed."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        # The missing package may be one that the imported one needs.
        package = (error.name or module).partition(".")[0]
        raise MissingExtraError(f"{package} is not installed: {install(extra)}") from error
