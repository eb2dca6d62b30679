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
"""Endings of files that hold a law, a network, or a model of stable-baselines3."""

POOL_POLICIES: Mapping[str, Callable[[Pool | None], LeaderPolicy]] = {
    TUNED_LAW: lambda pool: DampedLaw.tuned(_pool_name(pool)),
    LEARNED: lambda pool: LeaningLaw.learned(_pool_name(pool)),
}
"""Policies that are tuned or trained for a pool, by name."""

POLICIES: Mapping[str, Callable[[], LeaderPolicy]] = {
    PAPERS_LAW: SteeringLaw,
    DAMPED_LAW: DampedLaw,
    "straight ahead": StraightAhead,
    "random rudders": RandomRudders,
    # A law of the core that has no Python class needs no line here.
    **{name: partial(NamedLaw, name) for name in OTHER_LAWS},
}
"""Policies that are the same in every pool, by name."""

NAMES = (EVERY_SUBSTEP, *POLICIES, *POOL_POLICIES)
"""The names of all policies."""

_MODULE_ATTRIBUTE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


def _pool_name(pool: Pool | None) -> str:
    """Return the name of a pool; refuse None and pools given by their radii."""
    if not isinstance(pool, str):
        raise ParameterError(
            f"pool = {short_repr(pool)} is not accepted: tuned and learned leaders are for pools "
            "with a name"
        )
    return pool


def policy(given: PolicyLike, pool: Pool | None = None, *, trust: bool = False) -> Policy:
    """Return the policy for a name, a file or an object, checked. All users of policies call this.

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
        For attributes of a type that the options do not accept.
    """
    if given is None or (isinstance(given, str) and given == EVERY_SUBSTEP):
        law = _core.Law.named(EVERY_SUBSTEP)
        return Policy(source=SteeringLaw(), name=EVERY_SUBSTEP, control_hz=None, law=law)
    source = given if isinstance(given, Policy) else _source(given, pool, trust)
    checked = source if isinstance(source, Policy) else _checked(source)
    if pool is not None:
        checked.check_pool(pool)
    return checked


def _checked(source: LeaderPolicy) -> Policy:
    """Return the checked policy that acts by an object's ``predict``."""
    law = source.law if isinstance(source, LawPolicy) and source.is_law_itself else None
    leaders = source.leaders if isinstance(source, ModelPolicy) else 1
    return Policy.from_source(source, leaders=leaders, law=law)


def _source(given: PolicyLike, pool: Pool | None, trust: bool) -> LeaderPolicy | Policy:
    """Return the policy that `given` is, names, or returns when called."""
    source: object = given
    if isinstance(given, os.PathLike) or (isinstance(given, str) and given.endswith(FILES)):
        return load(given, trust=trust)
    if isinstance(given, str) and given in POLICIES:
        return POLICIES[given]()
    if isinstance(given, str) and given in POOL_POLICIES:
        return POOL_POLICIES[given](pool)
    if isinstance(given, str):
        source = _imported(given, trust)
    if isinstance(source, type) or (callable(source) and not hasattr(source, "predict")):
        try:
            source = source()
        except TypeError as error:
            raise _not_a_policy(source) from error
    source = as_policy(source)
    if isinstance(source, type) or not isinstance(source, LeaderPolicy):
        raise _not_a_policy(source)
    return source


def _not_a_policy(value: object) -> ParameterError:
    accepted = "a policy's name or file, an object with predict, or a function that returns one"
    if hasattr(value, "state_dict"):
        accepted += "; a network of torch becomes one by NetworkPolicy.from_module"
    return ParameterError(f"policy = {short_repr(value)} is not accepted: {accepted}")


def _unknown_name(name: str) -> ParameterError:
    parts = [part.strip() for part in name.split(",")]
    near = nearest(name, NAMES)
    if len(parts) > 1 and set(parts) <= {*NAMES}:
        hint = "policies are named one by one (on the command line, repeat the option)"
    else:
        hint = f"did you mean {near!r}?" if near else f"there are {quoted(NAMES)}"
    return ParameterError(f"{name!r} is not a policy and not a .json, .npz or .zip file: {hint}")


def _imported(name: str, trust: bool) -> object:
    """Return the object that ``"module:attribute"`` names, after importing its module.

    The module may be in the working directory.
    """
    if not _MODULE_ATTRIBUTE.fullmatch(name):
        raise _unknown_name(name)
    if not trust:
        raise ParameterError(
            f"{name} names code, and importing it executes it: if you know where it comes from, "
            "say so with trust=True (on the command line --trust)"
        )
    module, _, attribute = name.partition(":")
    # Add the working directory, as `python -m` does; an installed command does not.
    original_path = [*sys.path]
    sys.path.insert(0, os.getcwd())
    try:
        value: object = importlib.import_module(module)
        for part in attribute.split("."):
            value = getattr(value, part)
    except Exception as error:  # The module's own code may raise anything.
        raise ParameterError(f"{name} is not accepted: {type(error).__name__}: {error}") from error
    finally:
        sys.path[:] = original_path
    return value


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
        The named pool that the ``"learned"`` leaders were trained in, which they need. Refused with
        a file.
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
        return LeaningLaw.learned(_pool_name(pool))
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
    """Return names in one line, each in quotes, because some contain spaces."""
    return ", ".join(map(repr, names))
