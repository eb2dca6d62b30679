"""The ids of the environments: purpose and options of each."""

from collections.abc import Mapping
from typing import Any, NamedTuple


class Environment(NamedTuple):
    """The declaration of an id, from which its page is made."""

    #: A few sentences in Markdown.
    purpose: str
    #: Options that differ from the defaults.
    options: Mapping[str, Any]
    #: Changes, a sentence for each version.
    history: tuple[str, ...] = ("v0: initial version.",)


def _suite(
    purpose: str, n_leaders: int, episode_s: float = 480.0, **options: object
) -> Environment:
    """Return a task of suite v2. Never change one: make a new version of the suite instead."""
    # The flock's parameters are written out, so that a new default changes no task.
    flock = {"preset": "simulation", "n_boats": 27, "pool": "wide", "bw_s": 0.31, "dt_s": 0.02}
    flock |= {"n_leaders": n_leaders, "target": "cw"}
    return Environment(purpose, {"params": flock, "episode_s": episode_s, **options})


_TEN_BOATS: Mapping[str, Any] = {
    "n_boats": 10,
    "n_leaders": 4,
    "pool": "narrow",
    "observation": {"neighbors": 0, "target": False},
}


def _level(purpose: str, bw_s: float, episode_s: float, **options: object) -> Environment:
    """Return a level of suite v3: leaders learn to steer from scratch. Never change one."""
    flock = {"preset": "simulation", "bw_s": bw_s, "target": "random", "mirror_to_target": True}
    fixed = {"control_hz": 2.5, "reward": {"signed_order": 1.0}, "physics": "training"}
    return Environment(purpose, {**flock, **options, "episode_s": episode_s, **fixed})


ENVIRONMENTS: Mapping[str, Environment] = {
    "flockenv/Leaders-v0": Environment(
        "Three leaders among 27 boats, near the noise at which a flock loses its order. All other "
        "environments are this one with other options.",
        {},
    ),
    # Few boats, many leaders and small observations, so that learning needs few samples.
    "flockenv/Order-easy-v0": _level(
        "The environment to start with: four of ten boats lead and see few numbers. The order "
        "responds within seconds, so that plain PPO learns to lead in two minutes of one core.",
        bw_s=0.3,
        episode_s=120.0,
        **_TEN_BOATS,
    ),
    "flockenv/Order-noisy-v0": _level(
        "Order-easy with one and a half times its noise: the effect of a rudder is lost sooner.",
        bw_s=0.45,
        episode_s=120.0,
        **_TEN_BOATS,
    ),
    "flockenv/Order-narrow-v0": _level(
        "Can three leaders of 27 boats learn to steer in `narrow`, where boats stand close? They "
        "choose rudders from the default observation.",
        bw_s=0.45,
        episode_s=240.0,
        n_boats=27,
        n_leaders=3,
        pool="narrow",
    ),
    "flockenv/Order-wide-v0": _level(
        "Can three leaders of 27 boats learn to steer in `wide`, where the order responds within "
        "minutes? They choose rudders from the default observation.",
        bw_s=0.31,
        episode_s=480.0,
        n_boats=27,
        n_leaders=3,
        pool="wide",
    ),
    "flockenv/OneLeader-v0": _suite(
        "How far does one leader get? It leads 26 boats at the critical noise.", n_leaders=1
    ),
    "flockenv/ThreeLeaders-v0": _suite(
        "How do leaders share their work? Three lead 24 boats at the critical noise.", n_leaders=3
    ),
    "flockenv/Reversal-v0": _suite(
        "Can leaders turn a flock that circles the other way? The target alternates every four "
        "minutes, as in figure 7 of the paper.",
        n_leaders=3,
        episode_s=960.0,
        target="alternate",
    ),
    "flockenv/Camera-v0": _suite(
        "Does a policy work behind a camera? It misses 2 % of the positions, and its picture is "
        "one frame late.",
        n_leaders=3,
        dropout_rate=0.02,
        delay_frames=1,
    ),
    "flockenv/Noises-v0": _suite(
        "Does one policy work at any noise? Each episode draws its own, from half to 1.25 times "
        "the critical one.",
        n_leaders=3,
        bw_s=(0.155, 0.3875),
    ),
    "flockenv/Misinformed-v0": _suite(
        "Can two leaders play two roles? Leader 1 gets the wrong direction, and the order counts "
        "towards the direction of leader 0. With one policy for both, the mean order is 0.",
        n_leaders=2,
        target=("cw", "ccw"),
    ),
}
"""Every id that `import flockenv` registers."""
