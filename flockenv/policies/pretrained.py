"""Policies from files, and those of the named pools: tuned gains and pretrained leaders."""

import os
from collections.abc import Mapping
from importlib import resources
from typing import Any

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.policies.files import read_policy
from flockenv.policies.laws import LAWS, ObservedPolicy
from flockenv.policies.leaning_law import LeaningLaw
from flockenv.policies.model import ModelPolicy, is_model_file, load_model
from flockenv.policies.network import NetworkPolicy

__all__ = ["LEARNED", "TUNED_GAINS", "learned", "load", "tuned_law"]

LEARNED = "learned"
"""Name of the learned leaders, which are others in each pool."""

_KINDS: dict[str, type[NetworkPolicy] | type[LeaningLaw]] = {
    "network": NetworkPolicy,
    "leaning law": LeaningLaw,
    "nonlinear leaning law": LeaningLaw,
}


def _tuned_gains() -> dict[str, dict[str, dict[str, float]]]:
    by_law: dict[str, dict[str, dict[str, float]]] = {}
    for law, pool, gains in _core.tuned_gains():
        by_law.setdefault(law, {})[pool] = dict(gains)
    return by_law


TUNED_GAINS: Mapping[str, Mapping[str, Mapping[str, float]]] = _tuned_gains()
"""Gains by law and pool: found by `python baselines/tune_laws.py` (seed 0) for three leaders
among 27 boats at each pool's critical noise, on training seeds."""


def load(
    path: str | os.PathLike[str], *, pool: str | None = None, trust: bool = False
) -> NetworkPolicy | LeaningLaw | ModelPolicy:
    """Return the learned leaders of a pool, or a policy from its file.

    Nothing in an ``.npz`` file is ever executed. A model's ``.zip`` file of stable-baselines3 holds
    pickled objects, and **reading it executes whatever code the file holds**: trust only files
    whose origin you know.

    Parameters
    ----------
    path
        ``"learned"`` for the leaders that come with the package, a policy's ``.npz`` file, or the
        ``.zip`` file of a model that was trained with stable-baselines3 (needs the extra
        ``train``).
    pool
        With ``"learned"``, and then needed: the named pool that the leaders were trained in.
    trust
        Whether a model's ``.zip`` file may execute the code in it.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If the file is no policy, is damaged, or was made for another version of the observation;
        for a model's file without `trust`; for a pool without learned leaders.
    MissingExtraError
        For a model's file without the extra ``train``.
    """
    if path == LEARNED:
        return learned(pool)
    if pool is not None:
        raise ParameterError(
            f"pool = {pool!r} is not accepted with the file {os.fspath(path)!r}: a pool chooses "
            f"among the policies called {LEARNED!r}"
        )
    if is_model_file(path):
        if not trust:
            raise ParameterError(
                f"{path} holds a model with pickled objects, and reading it executes the code in "
                "it: if you know where it comes from, say so with trust=True (on the command line "
                "--trust)"
            )
        return load_model(path)
    header, arrays = read_policy(path)
    kind = header.get("kind", "network")
    try:
        if not isinstance(kind, str) or kind not in _KINDS:
            raise ParameterError(f"kind = {kind!r} is not accepted: one of {', '.join(_KINDS)}")
        return _KINDS[kind].from_file(header, arrays)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{path} is no whole policy: {error}") from error


def tuned_law(law: str, pool: Any) -> ObservedPolicy:
    """Return a law in `TUNED_GAINS` with the gains tuned in a named pool.

    Raises
    ------
    ParameterError
        For other pools.
    """
    return LAWS[law](**TUNED_GAINS[law][_named(pool)])


def learned(pool: Any) -> NetworkPolicy | LeaningLaw | ModelPolicy:
    """Return the pretrained leaders of a named pool.

    Raises
    ------
    ParameterError
        For other pools.
    """
    file = resources.files("flockenv.policies").joinpath("learned", f"{_named(pool)}.npz")
    with resources.as_file(file) as path:
        return load(path)


def _named(pool: Any) -> str:
    pools = TUNED_GAINS["damped law"]
    if not isinstance(pool, str) or pool not in pools:
        raise ParameterError(
            f"pool = {pool!r} is not accepted: tuned and learned leaders are for {', '.join(pools)}"
        )
    return pool
