"""Policies by name: closed-form laws, what is tuned or trained for a pool, and files."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from flockenv.errors import ParameterError, nearest
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.constant import RandomRudders, StraightAhead
from flockenv.policies.laws import LAWS
from flockenv.policies.pretrained import LEARNED, TUNED_GAINS, learned, load, tuned_law

__all__ = [
    "EVERY_SUBSTEP",
    "FILES",
    "POLICIES",
    "POOL_POLICIES",
    "named_policy",
    "policy_name",
    "quoted",
]

FILES = (".npz", ".zip")
"""How the files of policies end: learned ones of this package, and models of stable-baselines3."""

EVERY_SUBSTEP = "law"
"""Stands for the paper's law evaluated at every substep, from the pose: what `simulate` does."""

POLICIES: Mapping[str, Callable[[], LeaderPolicy | str]] = {
    **LAWS,
    "steering law at every substep": lambda: EVERY_SUBSTEP,
    "straight ahead": StraightAhead,
    "random rudders": RandomRudders,
}
"""Policies by name that are the same in every pool."""

POOL_POLICIES: Mapping[str, Callable[[Any], LeaderPolicy]] = {
    **{f"tuned {law}": partial(tuned_law, law) for law in TUNED_GAINS},
    LEARNED: learned,
}
"""Policies by name, each tuned or trained for a pool."""

_LONGEST_NAME = 200

_ALSO_CALLED = {
    EVERY_SUBSTEP: "steering law at every substep",
    "steering law, every substep": "steering law at every substep",
}


def named_policy(name: str, pool: Any, *, trust: bool = False) -> Callable[[], LeaderPolicy | str]:
    """Return a function that returns a policy, given its name or the path of its file.

    Parameters
    ----------
    name
        A name in `POLICIES` or `POOL_POLICIES`, `EVERY_SUBSTEP`, or a path.
    pool
        The flock's pool.
    trust
        Whether a model's ``.zip`` file may execute the code in it; see `load`.

    Raises
    ------
    ParameterError
        For unknown names, files that are no policy, models' files without `trust`, and pools that
        a policy is not made for.
    OSError
        If the file cannot be opened.
    """
    name = _ALSO_CALLED.get(name, name)
    if name in POLICIES:
        return POLICIES[name]
    if name in POOL_POLICIES:
        found = POOL_POLICIES[name](pool)
        return lambda: found
    if name.endswith(FILES):
        read = load(name, trust=trust)
        return lambda: read
    names = [*POLICIES, *POOL_POLICIES]
    parts = [part.strip() for part in name.split(",")]
    near = nearest(name, names)
    if len(parts) > 1 and set(parts) <= {*names, *_ALSO_CALLED}:
        hint = "policies are named one by one (on the command line, repeat the option)"
    else:
        hint = f"did you mean {near!r}?" if near else f"there are {quoted(names)}"
    raise ParameterError(f"{name!r} is no policy and no .npz or .zip file: {hint}")


def policy_name(policy: LeaderPolicy | str | None) -> str:
    """Return the name under which recordings hold a policy.

    That is "law" for the steering law at every substep, and otherwise what the policy prints as,
    or its class where that is no name. A policy's ``digest`` follows, if it has one.
    """
    if policy is None or isinstance(policy, str):
        return policy or EVERY_SUBSTEP
    kind = type(policy)
    shown = repr(policy) if kind.__repr__ is not object.__repr__ else ""
    name = shown if 0 < len(shown) <= _LONGEST_NAME and shown.isprintable() else kind.__qualname__
    return f"{name} {getattr(policy, 'digest', '')}".strip()


def quoted(names: list[str]) -> str:
    """Return names in a row, each in quotes: some hold spaces."""
    return ", ".join(map(repr, names))
