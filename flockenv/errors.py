"""What can go wrong: the exceptions that users meet."""

from flockenv._core import EpisodeError, FlockError, InUseError, ParameterError, SolverError

__all__ = [
    "EpisodeError",
    "FlockError",
    "InUseError",
    "ParameterError",
    "SolverError",
    "UnknownOptionError",
    "shown",
]


class UnknownOptionError(ParameterError, TypeError):
    """An environment was given a keyword argument that is none of its options.

    A `TypeError` too, as of any other function: libraries try out optional arguments and leave out
    those that are refused so (TorchRL's ``GymEnv``: ``frameskip``).
    """


def shown(value: object) -> str:
    """Return a value as messages show it: its repr, cut at a length that fits a line."""
    try:
        text = repr(value)
    except Exception:  # That of an int of more than 4300 digits fails, and others may.
        return "a value that cannot be printed"
    return text if len(text) <= 80 else f"{text[:80]}…"
