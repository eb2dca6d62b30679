"""What can go wrong: the exceptions that users meet."""

from flockenv._core import EpisodeError, FlockError, ParameterError, SolverError

__all__ = ["EpisodeError", "FlockError", "ParameterError", "SolverError", "UnknownOptionError"]


class UnknownOptionError(ParameterError, TypeError):
    """An environment was given a keyword argument that is none of its options.

    A `TypeError` too, as of any other function: libraries try out optional arguments and leave out
    those that are refused so (TorchRL's ``GymEnv``: ``frameskip``).
    """
