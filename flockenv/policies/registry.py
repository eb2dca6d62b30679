"""Policies by name, by file, and in every other accepted form."""

import importlib
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import partial

from flockenv import _core
from flockenv.errors import ParameterError, nearest, short_repr
from flockenv.policies.base import LeaderPolicy, Policy, Pool
from flockenv.policies.constant import RandomRudders, StraightAhead
from flockenv.policies.laws import DampedLaw, LawPolicy, LeaningLaw, NamedLaw, SteeringLaw
from flockenv.policies.model import ModelPolicy, as_policy, is_model_file, load_model
from flockenv.policies.names import (
    DAMPED_LAW,
    EVERY_SUBSTEP,
    LEARNED,
    OTHER_LAWS,
    PAPERS_LAW,
    TUNED_LAW,
)
from flockenv.policies.network import NetworkPolicy

PolicyLike = Policy | LeaderPolicy | str | os.PathLike[str] | Callable[[], object] | None
"""Forms in which a policy may be given; see `policy`."""

FILES = (".json", ".npz", ".zip")
"""Endings of policies' files: laws, networks, and models of stable-baselines3."""

POOL_POLICIES: Mapping[str, Callable[[Pool | None], LeaderPolicy]] = {
    TUNED_LAW: lambda pool: DampedLaw.tuned(_named(pool)),
    LEARNED: lambda pool: LeaningLaw.learned(_named(pool)),
}
"""Policies by name, each tuned or trained for a pool."""

POLICIES: Mapping[str, Callable[[], LeaderPolicy]] = {
    PAPERS_LAW: SteeringLaw,
    DAMPED_LAW: DampedLaw,
    "straight ahead": StraightAhead,
    "random rudders": RandomRudders,
    # A law of the core that has no Python class needs no line here.
    **{name: partial(NamedLaw, name) for name in OTHER_LAWS},
}
"""Policies by name that are the same in every pool."""

NAMES = (EVERY_SUBSTEP, *POLICIES, *POOL_POLICIES)
"""The names of all policies."""

_ATTRIBUTE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


def _named(pool: Pool | None) -> str:
    if not isinstance(pool, str):
        raise ParameterError(
            f"pool = {short_repr(pool)} is not accepted: tuned and learned leaders are for pools "
            "with a name"
        )
    return pool


def policy(given: PolicyLike, pool: Pool | None = None, *, trust: bool = False) -> Policy:
    """Return the policy for a name, a file or an object. All policies pass through here.

    Parameters
    ----------
    given
        A name, such as "learned" or "damped law"; the path of a policy's file (see `load`); a model
        of stable-baselines3; any object whose ``predict`` maps observations to actions; a function
        or a class without arguments that returns one; ``"module:attribute"``, which names one of
        these; or None for the paper's law at every substep. Attributes of an object say what it is
        made for: ``control_hz``, ``pool``, ``observation``, ``mirror_to_target``, ``action_mode``
        and ``decision_period_s``, each as in the environments' options.
    pool
        The pool of the flock, by name or as two radii; the laws that are tuned or learned for a
        pool need it.
    trust
        Whether code may be executed: that of a module, and that in a model's ``.zip`` file.

    Raises
    ------
    OSError
        If a file cannot be opened.
    ParameterError
        For unknown names, files that `load` refuses, a pool that the policy was not made for, and
        anything that is not a policy.
    TypeError
        For attributes of another kind than the options have.
    """
    if given is None or (isinstance(given, str) and given == EVERY_SUBSTEP):
        every = _core.Law.named(EVERY_SUBSTEP)
        return Policy(source=SteeringLaw(), name=EVERY_SUBSTEP, control_hz=None, law=every)
    found = given if isinstance(given, Policy) else _source(given, pool, trust)
    if not isinstance(found, Policy):
        law = found.law if isinstance(found, LawPolicy) else None
        leaders = found.leaders if isinstance(found, ModelPolicy) else 1
        found = Policy.from_source(found, leaders=leaders, law=law)
    if pool is not None:
        found.check_pool(pool)
    return found


def _source(given: PolicyLike, pool: Pool | None, trust: bool) -> LeaderPolicy | Policy:
    """Return the object with ``predict`` that a value is or names."""
    made: object = given
    if isinstance(given, os.PathLike) or (isinstance(given, str) and given.endswith(FILES)):
        return load(given, trust=trust)
    if isinstance(given, str) and given in POLICIES:
        return POLICIES[given]()
    if isinstance(given, str) and given in POOL_POLICIES:
        return POOL_POLICIES[given](pool)
    if isinstance(given, str):
        made = _attribute(given, trust)
    if isinstance(made, type) or (callable(made) and not hasattr(made, "predict")):
        try:
            made = made()
        except TypeError as error:
            raise _not_a_policy(made) from error
    made = as_policy(made)
    if isinstance(made, type) or not isinstance(made, LeaderPolicy):
        raise _not_a_policy(made)
    return made


def _not_a_policy(found: object) -> ParameterError:
    words = "a policy's name or file, an object with predict, or a function that returns one"
    if hasattr(found, "state_dict"):
        words += "; a network of torch becomes one by NetworkPolicy.from_module"
    return ParameterError(f"policy = {short_repr(found)} is not accepted: {words}")


def _unknown_name(name: str) -> ParameterError:
    parts = [part.strip() for part in name.split(",")]
    near = nearest(name, NAMES)
    if len(parts) > 1 and set(parts) <= {*NAMES}:
        hint = "policies are named one by one (on the command line, repeat the option)"
    else:
        hint = f"did you mean {near!r}?" if near else f"there are {quoted(NAMES)}"
    return ParameterError(f"{name!r} is not a policy and not a .json, .npz or .zip file: {hint}")


def _attribute(name: str, trust: bool) -> object:
    """Return the object ``"module:attribute"``, also of a module in the working directory."""
    if not _ATTRIBUTE.fullmatch(name):
        raise _unknown_name(name)
    if not trust:
        raise ParameterError(
            f"{name} names code, and importing it executes it: if you know where it comes from, "
            "say so with trust=True (on the command line --trust)"
        )
    module, _, attribute = name.partition(":")
    # Add the working directory, as `python -m` does; an installed command does not.
    path, folder = [*sys.path], os.getcwd()
    sys.path.insert(0, folder)
    try:
        found: object = importlib.import_module(module)
        for part in attribute.split("."):
            found = getattr(found, part)
    except Exception as error:  # The module's own code may raise anything.
        raise ParameterError(f"{name} is not accepted: {type(error).__name__}: {error}") from error
    finally:
        sys.path[:] = path
    return found


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
        If the file is not a policy, is damaged, or was made for other features or another version
        of the observation; for a model's file without `trust`; for a pool without learned leaders.
    MissingExtraError
        For a model's file without the extra ``train``.
    """
    if path == LEARNED:
        return LeaningLaw.learned(_named(pool))
    if pool is not None:
        raise ParameterError(
            f"pool = {short_repr(pool)} is not accepted with the file {os.fspath(path)!r}: only "
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


def quoted(names: Iterable[str]) -> str:
    """Return names in one line, each in quotes, since some hold spaces."""
    return ", ".join(map(repr, names))
