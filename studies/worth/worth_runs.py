"""The runs of the worth of leaders: a few leaders of one policy, alone or against the law."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import flockenv
from studies.study import FIRST_SEED, Row, Study, flock

RUNS, MORE_RUNS = 64, 256  # Seeds of every line, and of those of 27 boats.
DENSITY_BOATS = 27
LAW = "law"
POLICIES = (LAW, "learned", "tuned law", "damped law")
NOISES_S = (0.31, 0.4, 0.2, 0.5)
"""The critical noise of 27 boats in the wide pool first."""


def design() -> list[Row]:
    """Return the runs: the critical noise of 27 boats first, then noises, sizes and opponents."""
    cells: list[tuple[int, float, int, str, int]] = []
    for bw_s in NOISES_S:
        cells += [(27, bw_s, 0, LAW, 0)]
        cells += [(27, bw_s, 1, policy, 0) for policy in POLICIES[:3]]
        if bw_s == NOISES_S[0]:
            cells += [(27, bw_s, 2, LAW, 0), (27, bw_s, 1, POLICIES[3], 0)]
            cells += [(27, bw_s, 2, LAW, 1), (27, bw_s, 3, LAW, 1), (27, bw_s, 1, "learned", 2)]
    for n_boats, leaders in ((100, 4), (400, 15)):
        for policy in POLICIES[:3]:
            cells.append((n_boats, NOISES_S[0], leaders, policy, 0))
        cells.append((n_boats, NOISES_S[0], 0, LAW, 0))
    return [
        {"n_boats": n_boats, "bw_s": bw_s, "leaders": leaders, "policy": policy}
        | {"against": against, "dt_s": 0.05, "minutes": 24.0, "seed": seed}
        for first, last in ((0, RUNS), (RUNS, MORE_RUNS))
        for n_boats, bw_s, leaders, policy, against in cells
        if last == RUNS or n_boats == DENSITY_BOATS
        for seed in range(first, last)
    ]


class _Against:
    """A policy for the first leaders and the paper's law for the rest, from one observation."""

    def __init__(self, policy: Any, leaders: int) -> None:
        self.observation = dict(getattr(policy, "observation", None) or {})
        self.mirror_to_target = bool(getattr(policy, "mirror_to_target", False))
        self._policy, self._leaders = policy, leaders
        self._law = flockenv.policies.SteeringLaw(
            observation=self.observation, mirror_to_target=self.mirror_to_target
        )

    def predict(self, observation: Any, state: Any = None, *_: Any, **__: Any) -> tuple[Any, Any]:
        ours, state = self._policy.predict(observation, state)
        theirs, _ = self._law.predict(observation)
        return np.concatenate([ours[: self._leaders], theirs[self._leaders :]]), state


def of_pool(row: Row, sides: Sequence[str] = ()) -> flockenv.FlockParameters:
    """Return the flock of a row in a pool of one shape and density; leaders head for `sides`."""
    scale = math.sqrt(row["n_boats"] / DENSITY_BOATS)
    return flock(
        row,
        n_leaders=len(sides),
        target=tuple(sides) or "cw",
        pool="wide" if row["n_boats"] == DENSITY_BOATS else (180.0 * scale, 97.0 * scale),
    )


def steering(row: Row) -> Any:
    """Return the policy of a row's leaders; None is the paper's law."""
    if row["policy"] == LAW:
        return None
    policy = flockenv.policies.policy(row["policy"], "wide").source
    if isinstance(policy, flockenv.policies.LeaningLaw) and row["n_boats"] != DENSITY_BOATS:
        policy.pool = None  # It refuses other pools than its own, also those of the same shape.
    return policy


def measure(row: Row) -> Row:
    """Return means of m over the analysis window after the first third of a run."""
    sides = ["cw"] * row["leaders"] + ["ccw"] * row["against"]
    policy = steering(row) if sides else None
    if policy is not None and row["against"]:
        policy = _Against(policy, row["leaders"])
    run = flockenv.simulate(
        of_pool(row, sides),
        FIRST_SEED + row["seed"],
        60.0 * row["minutes"],
        sample_hz=2.0,
        policy=policy,
        dtype=np.float32,
    )
    m = run.analyzed(1 / 3).order.rotation()
    return {"m": m.mean(), "m_squared": (m**2).mean(), "abs_m": abs(m).mean()}


STUDY = Study("worth/worth", design, measure, lambda row: row["n_boats"] <= 100)
