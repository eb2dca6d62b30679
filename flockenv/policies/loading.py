"""`load`: learned policies of every kind from their files."""

import os

from flockenv.errors import ParameterError
from flockenv.policies.leaning_law import LeaningLaw
from flockenv.policies.network import NetworkPolicy
from flockenv.policies.policy_file import read_policy

__all__ = ["load"]

_KINDS: dict[str, type[NetworkPolicy] | type[LeaningLaw]] = {
    "network": NetworkPolicy,
    "leaning law": LeaningLaw,
}


def load(path: str | os.PathLike[str]) -> NetworkPolicy | LeaningLaw:
    """Read a shipped or trained policy; nothing in the file is ever executed.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no policy file, is damaged, or was made for another version of the observation.
    """
    header, arrays = read_policy(path)
    try:
        return _KINDS[header.get("kind", "network")].from_file(header, arrays)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(f"{path} is no whole policy: {error!r}") from error
