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
    kind = header.get("kind", "network")
    try:
        if not isinstance(kind, str) or kind not in _KINDS:
            raise ParameterError(f"kind = {kind!r} is not accepted: one of {', '.join(_KINDS)}")
        return _KINDS[kind].from_file(header, arrays)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{path} is no whole policy: {error}") from error
