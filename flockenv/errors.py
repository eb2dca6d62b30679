"""What can go wrong: the exceptions that users meet."""

__all__ = ["EpisodeError", "FlockError", "ParameterError", "SolverError", "UnknownOptionError"]


class FlockError(Exception):
    """Base of every error that flockenv raises by itself."""


class ParameterError(FlockError, ValueError):
    """A parameter, argument, array, state, snapshot or file is not acceptable.

    The message names it, shows the value and says what would be accepted. Nothing has changed.
    """


class UnknownOptionError(ParameterError, TypeError):
    """An environment was given a keyword argument that is none of its options.

    A `TypeError` too, as of any other function: libraries try out optional arguments and leave out
    those that are refused so (TorchRL's ``GymEnv``: ``frameskip``).
    """


class EpisodeError(FlockError, RuntimeError):
    """An environment was stepped before a reset or after the end of its episode."""


class SolverError(FlockError, RuntimeError):
    """The motion left the range of 1e9 (cm, cm/s, rad, rad/s).

    The flock is where it was before the call.
    """
