"""What can go wrong: the exceptions that users meet."""

__all__ = ["EpisodeError", "FlockError", "ParameterError", "SolverError"]


class FlockError(Exception):
    """Base of every error that flockenv raises by itself."""


class ParameterError(FlockError, ValueError):
    """A parameter, argument, array, state, snapshot or file is not acceptable.

    The message names it, shows the value and says what would be accepted. Nothing has changed.
    """


class EpisodeError(FlockError, RuntimeError):
    """An environment was stepped before a reset or after the end of its episode."""


class SolverError(FlockError, RuntimeError):
    """The motion left the range of 1e9 (cm, cm/s, rad, rad/s).

    The flock is where it was before the call.
    """
