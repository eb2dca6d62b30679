"""Shared parts of the environments' docstrings, with tables from the core's data."""

import inspect
from typing import TypeVar

from flockenv import _core
from flockenv.envs.observation import (
    feature_table,
    flock_feature_entries,
    observation_entries,
    observation_table,
    state_entries,
)
from flockenv.envs.options import arguments_table
from flockenv.envs.reward import terms_table
from flockenv.order import QUANTITIES

__all__ = ["specified"]

_Class = TypeVar("_Class", bound=type)

_TASK = """Boats drive through a ring-shaped pool in cycles: forward for 2 s, drift, backward for
`bw_s`, drift. Only frictionless, perfectly inelastic collisions align them. Backing makes boats
spin and destroys order, the more the longer it lasts (Tarcai et al. 2011). A few boats, the
leaders, have a rudder. The task is to make the *normal* boats circulate in the target direction."""

_FIRST = """`flockenv/Order-easy-v0` is the environment to start with: ten boats, four of which lead
and are rewarded for the order of the others. Plain PPO passes the paper's law within two minutes of
processor time, which docs/train_in_four_minutes.md shows. The other interfaces take the same
options: `gymnasium.spec("flockenv/Order-easy-v0").kwargs`. The ids are registered by
`import flockenv`; `gymnasium.make("flockenv:flockenv/Order-easy-v0")` imports it by itself."""

_RUDDER = """A rudder is held for a control step. A positive rudder turns a boat that moves forward
counter-clockwise, and works in reverse on a boat that moves backward. Numbers beyond ±1 are
clipped. NaN is an error, and nothing moves then. With `rudder_levels=n`, levels 0 to n - 1 are
rudders evenly spaced from -1 to 1, which `policies.WithLevels` chooses for a policy of rudders.
With `action_mode="heading"` an action stands for a heading, its angle outward of the target's
tangent over π, and `DampedLaw()` steers to it in every control step. With `"lean"` it stands for
that angle over 1.2 rad, and the damped law with the gains tuned in the pool steers to it: 0 is that
law itself, bit for bit. Both laws read what the leader sees of itself. A step holds its action for
`decision_period_s`; its reward is the sum over those control steps, or over fewer where the episode
ends, and its `reward_terms` are means over them."""

_GENERAL_SUM = """With `target` a list of "cw" and "ccw", one per leader, each leader has a target
of its own: its observation, the reflection of `mirror_to_target`, what its actions stand for and
all its reward terms are towards that one, as if it were everybody's. Leaders with opposite targets
play a general-sum game: their `signed_order` sums to zero, the terms of a leader alone do not. What
belongs to the whole flock refers to leader 0's target: the `signed_order` and
`share_towards_target` of the `"episode_summary"`, the reflection of `state()`, and the flock
features of an environment (those of a `LeaderVecEnv` are in the frame of each slot's target). The
`target` of `state()` is the mean over the leaders."""

_FRAME = """All entries are in the local-angle polar (LAP) frame of the leader's own position,
outward and clockwise. They are scaled, and clipped at the bounds below; the share of clipped
numbers is reported at the end of the episode. The entries of `neighbors` repeat for each of the
nearest boats, nearest first, those of `obstacles` for each of the nearest discs and walls, and
those of `fellow_leaders` for each of the nearest other leaders, however far they are. The blocks
`law_rudder`, `obstacles` and `fellow_leaders` are off unless `observation` switches them on."""

_START = """Boats start at rest at random positions with random headings, without overlap, in phase
fw. The seed fixes the initial state, the noise (whatever the policy does), the target and the
backward duration; the first episode's flock is `Flock(parameters, seed)`. `reset(options=...)` can
set for one episode: `target`, `bw_s`, `state` (a dictionary with pose (n, 3) and optionally
velocity (n, 3), time_s and allow_overlap as in `Flock.set_state`) or `snapshot` (bytes of
`Flock.snapshot`)."""

_MEANS = ", ".join(
    f"`{each.name}`" for each in QUANTITIES if each.is_averaged and each.kind != "structure"
)

_END = f"""After `episode_s` the episode is truncated; it never terminates. The `"episode_summary"`
has the episode's `flock_seed`, `bw_s`, `steps` (control steps), `total_reward` and means of the
`reward_terms` over steps and leaders; means of quantities of the normal boats over the analysis
window after the first tenth of the episode ({_MEANS}) and `share_towards_target`
(part of that time with a signed order above 0.5); `ordering_time_s` and `ordering_time_wide_s`
(eq. 7, with the angle π/20 as printed and with π/4); and `clip_rate`. An ordering time that never
came is infinite. An episode that ends before its first analysis window has no means over it: those
entries are left out. Where each leader has a target of its own the summary also has arrays (k,):
`leader_targets` (+1 clockwise, -1 counter-clockwise), `leader_total_rewards`,
`leader_signed_orders` and `leader_shares_towards_target`, each towards the leader's own."""

_HISTORY = """- v0, observation version 1: initial version. Where the block `obstacles` or
  `fellow_leaders` is on, it is added at the end, and the version of the observation is 2."""

# Those that are off by default, too.
_EVERY_BLOCK = {
    block: type(repeats)(1)
    for block, repeats in _core.env_defaults()["observation"].items()
    if not repeats
}

_SHARED = {
    "task": _TASK,
    "start": _FIRST,
    "rudder": _RUDDER,
    "frame": _FRAME,
    "general_sum": _GENERAL_SUM,
    "observation_table": observation_table(observation_entries(_EVERY_BLOCK)),
    "state_table": observation_table(state_entries(1)),
    "flock_feature_table": feature_table(flock_feature_entries()),
    "flock_feature_count": str(len(flock_feature_entries())),
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
