"""Docstrings of the environments: what they share, with tables from the core's data."""

import inspect
from typing import TypeVar

from flockenv.envs.observation import (
    OBSERVATION_VERSION,
    observation_entries,
    observation_table,
    state_entries,
)
from flockenv.envs.options import arguments_table
from flockenv.envs.reward import terms_table

__all__ = ["specified"]

_Class = TypeVar("_Class", bound=type)

_TASK = """Boats drive through a ring-shaped pool: forward for 2 s, drifting, backward for `bw_s`,
drifting, and so on. They align by nothing but frictionless, perfectly inelastic collisions;
backing makes them spin, the more the longer it lasts, which destroys order (Tarcai et al. 2011). A
few of them, the leaders, have a rudder. The task is to make the *normal* boats circulate in the
target direction."""

_RUDDER = """A rudder is held for a control step. A positive one turns a boat that moves forward
counter-clockwise, and works in reverse on one that moves backward. Numbers beyond ±1 are clipped,
NaN is an error and nothing moves. With `rudder_levels=n` levels 0 to n - 1 are rudders evenly
spaced from -1 to 1; `policies.WithLevels` chooses them for a policy that gives rudders."""

_FRAME = """Everything is in the local-angle polar (LAP) frame of the leader's own place, outward
and clockwise, scaled and clipped at the bounds below (the part of numbers that were clipped is told
at the episode's end). The entries of `neighbors` repeat for each of the nearest boats, nearest
first."""

_START = """Boats at random places with random headings, not overlapping, at rest; phase fw begins.
The seed fixes the start, the noise (whatever the policy does), the target and the noise level; the
first episode's flock is `Flock(parameters, seed)`. `reset(options=...)` can set for one episode:
`target`, `bw_s`, `state` (a dictionary with pose (n, 3) and, if need be, velocity (n, 3), time_s
and allow_overlap as in `Flock.set_state`) or `snapshot` (bytes of `Flock.snapshot`)."""

_END = "After `episode_s` the episode is truncated; it never terminates."

_HISTORY = f"- v0, observation version {OBSERVATION_VERSION}: initial version."

_SHARED = {
    "task": _TASK,
    "rudder": _RUDDER,
    "frame": _FRAME,
    "observation_table": observation_table(observation_entries()),
    "state_table": observation_table(state_entries(1)),
    "reward_table": terms_table(),
    "starting_state": _START,
    "episode_end": _END,
    "arguments_table": arguments_table(),
    "version_history": _HISTORY,
}


def specified(environment: _Class) -> _Class:
    """Fill the placeholders of a class's docstring."""
    text = inspect.cleandoc(environment.__doc__ or "")
    for name, shared in _SHARED.items():
        text = text.replace(f"{{{name}}}", shared)
    environment.__doc__ = text
    return environment
