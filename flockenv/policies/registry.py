"""Policies by name: laws, what is tuned or trained for a pool, and files."""

import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from flockenv.errors import ParameterError, nearest, shown
from flockenv.policies.base import LeaderPolicy, check_pool
from flockenv.policies.constant import RandomRudders, StraightAhead
from flockenv.policies.laws import DampedLaw, LeaningLaw, NamedLaw, SteeringLaw
from flockenv.policies.model import ModelPolicy, is_model_file, load_model
from flockenv.policies.names import (
    DAMPED_LAW,
    EVERY_SUBSTEP,
    LEARNED,
    OTHER_LAWS,
    PAPERS_LAW,
    TUNED_LAW,
)
from flockenv.policies.network import NetworkPolicy

FILES = (".json", ".npz", ".zip")
"""How the files of policies end: laws, networks, and models of stable-baselines3."""

POOL_POLICIES: Mapping[str, Callable[[Any], LeaderPolicy]] = {
    TUNED_LAW: lambda pool: DampedLaw.tuned(_named(pool)),
    LEARNED: lambda pool: LeaningLaw.learned(_named(pool)),
}
"""Policies by name, each tuned or trained for a pool."""

POLICIES: Mapping[str, Callable[[], LeaderPolicy | str]] = {
    PAPERS_LAW: SteeringLaw,
    DAMPED_LAW: DampedLaw,
    EVERY_SUBSTEP: lambda: EVERY_SUBSTEP,
    "straight ahead": StraightAhead,
    "random rudders": RandomRudders,
    # A law of the core without a class has a line there alone.
    **{name: partial(NamedLaw, name) for name in OTHER_LAWS},
}
"""Policies by name that are the same in every pool."""

_LONGEST_NAME = 200


def _named(pool: Any) -> str:
    if not isinstance(pool, str):
        raise ParameterError(
            f"pool = {shown(pool)} is not accepted: tuned and learned leaders are for pools with a "
            "name"
        )
    return pool


def load(
    path: str | os.PathLike[str], *, pool: str | None = None, trust: bool = False
) -> LeaningLaw | NetworkPolicy | ModelPolicy:
    """Return the learned leaders of a pool, or a policy from its file.

    Nothing in a ``.json`` or ``.npz`` file is ever executed. A model's ``.zip`` file of
    stable-baselines3 holds pickled objects, and **reading it executes whatever code the file
    holds**: trust only files whose origin you know.

    Parameters
    ----------
    path
        ``"learned"`` for the leaders that come with the package, a law's ``.json`` file, a
        network's ``.npz`` file, or the ``.zip`` file of a model that was trained with
        stable-baselines3 (needs the extra ``train``).
    pool
        With ``"learned"``, and then needed: the named pool that the leaders were trained in.
    trust
        Whether a model's ``.zip`` file may execute the code in it.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If the file is no policy, is damaged, or was made for other features or another version of
        the observation; for a model's file without `trust`; for a pool without learned leaders.
    MissingExtraError
        For a model's file without the extra ``train``.
    """
    if path == LEARNED:
        return LeaningLaw.learned(_named(pool))
    if pool is not None:
        raise ParameterError(
            f"pool = {shown(pool)} is not accepted with the file {os.fspath(path)!r}: only "
            f"{LEARNED!r} takes one"
        )
    if is_model_file(path):
        if not trust:
            raise ParameterError(
                f"{path} holds a model with pickled objects, and reading it executes the code in "
                "it: if you know where it comes from, say so with trust=True (on the command line "
                "--trust)"
            )
        return load_model(path)
    if os.fspath(path).endswith(".json"):
        return LeaningLaw.load(path)
    return NetworkPolicy.load(path)


def named_policy(name: str, pool: Any, *, trust: bool = False) -> Callable[[], LeaderPolicy | str]:
    """Return a function that returns a policy, given its name or the path of its file; see `load`.

    Names are those in `POLICIES` and `POOL_POLICIES`; the latter need the flock's pool. Unknown
    names, files that are no policy and pools that a policy is not made for are refused.
    """
    if name in POLICIES:
        return POLICIES[name]
    if name in POOL_POLICIES:
        found = POOL_POLICIES[name](pool)
        return lambda: found
    if name.endswith(FILES):
        read = load(name, trust=trust)
        check_pool(read, pool)
        return lambda: read
    names = [*POLICIES, *POOL_POLICIES]
    parts = [part.strip() for part in name.split(",")]
    near = nearest(name, names)
    if len(parts) > 1 and set(parts) <= {*names}:
        hint = "policies are named one by one (on the command line, repeat the option)"
    else:
        hint = f"did you mean {near!r}?" if near else f"there are {quoted(names)}"
    raise ParameterError(f"{name!r} is no policy and no .json, .npz or .zip file: {hint}")


def policy_name(policy: LeaderPolicy | str | None) -> str:
    """Return the name under which recordings hold a policy.

    Without a policy it is `EVERY_SUBSTEP`. Otherwise it is the policy's text, or its class if the
    text is no name, and then the policy's ``digest``, if it has one.
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
