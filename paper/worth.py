"""What is a leader worth? The flock's response to a few leaders, in units of the paper's law.

The rule of the answer stands in worth.md and was committed before the first run.
"""

import math
from typing import Any

import numpy as np
import pandas as pd
from claim import Claim, Interval, bca, mean, write_claims
from study import COLORS, FIRST_SEED, Options, Row, Study, curve, flock, main, picture

import flockenv
from flockenv.comparison import named_policy

RUNS = 64
DENSITY_BOATS = 27
LAW = "law"
POLICIES = (LAW, "learned", "tuned damped law", "damped law")
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
        {
            "n_boats": n_boats,
            "bw_s": bw_s,
            "leaders": leaders,
            "policy": policy,
            "against": against,
            "dt_s": 0.05,
            "minutes": 24.0,
            "seed": seed,
        }
        for n_boats, bw_s, leaders, policy, against in cells
        for seed in range(RUNS)
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


def measure(row: Row) -> Row:
    """Return means of m over the analysis window after the first third of a run."""
    sides = ["cw"] * row["leaders"] + ["ccw"] * row["against"]
    scale = math.sqrt(row["n_boats"] / DENSITY_BOATS)
    parameters = flock(
        row,
        n_leaders=len(sides),
        target=tuple(sides) or "cw",
        pool="wide" if row["n_boats"] == DENSITY_BOATS else (180.0 * scale, 97.0 * scale),
    )
    policy = None if row["policy"] == LAW or not sides else _policy(row["policy"])
    if policy is not None and row["against"]:
        policy = _Against(policy, row["leaders"])
    run = flockenv.simulate(
        parameters,
        FIRST_SEED + row["seed"],
        60.0 * row["minutes"],
        sample_hz=2.0,
        policy=policy,
        dtype=np.float32,
    )
    m = run.analyzed(1 / 3).order.rotation()
    return {"m": m.mean(), "m_squared": (m**2).mean(), "abs_m": abs(m).mean()}


def _policy(name: str) -> Any:
    return named_policy(name, "wide")()


STUDY = Study("worth", design, measure, lambda row: row["n_boats"] <= 100)


def of(table: pd.DataFrame, **values: Any) -> np.ndarray:
    """Return m and m² of the runs with these values, shape (runs, 2)."""
    chosen = table
    for name, value in values.items():
        chosen = chosen[chosen[name] == value]
    return chosen[["m", "m_squared"]].to_numpy()


def slope(table: pd.DataFrame, policy: str, n_boats: int, bw_s: float) -> Interval:
    """Return the flock's response per leader, by the fewest leaders that were run."""
    leaders = {27: 1, 100: 4, 400: 15}[n_boats]
    runs = of(table, policy=policy, n_boats=n_boats, bw_s=bw_s, leaders=leaders, against=0)
    value, low, high = mean(runs[:, 0])
    return value / leaders, low / leaders, high / leaders


def worth(table: pd.DataFrame, policy: str, n_boats: int, bw_s: float) -> Interval:
    """Return a policy's response over that of the law, with as many leaders."""
    leaders = {27: 1, 100: 4, 400: 15}[n_boats]
    same = {"n_boats": n_boats, "bw_s": bw_s, "leaders": leaders, "against": 0}
    groups = [of(table, policy=name, **same) for name in (policy, LAW)]
    if min(map(len, groups)) < 3:
        return math.nan, math.nan, math.nan
    return bca(groups, lambda ours, theirs: ours[..., 0].mean(-1) / theirs[..., 0].mean(-1))


def gain(table: pd.DataFrame, bw_s: float) -> Interval:
    """Return the law's response per leader over n times the variance of m without leaders."""
    same = {"n_boats": 27, "bw_s": bw_s, "policy": LAW, "against": 0}
    led, free = of(table, leaders=1, **same), of(table, leaders=0, **same)
    if min(len(led), len(free)) < 3:
        return math.nan, math.nan, math.nan
    return bca([led, free], lambda a, b: a[..., 0].mean(-1) / (27 * b[..., 1].mean(-1)))


def judge(table: pd.DataFrame) -> list[Claim]:
    """Judge worth, additivity and the response against the fluctuations."""
    claims = []
    reading = "simulation (leapfrog, white), wide"
    places = [(27, bw_s) for bw_s in NOISES_S] + [(100, 0.31), (400, 0.31)]
    for n_boats, bw_s in places:
        for policy in POLICIES[1:]:
            found = worth(table, policy, n_boats, bw_s)
            runs = len(of(table, policy=policy, n_boats=n_boats, bw_s=bw_s, against=0))
            if runs:
                where = f"{reading}, n = {n_boats}"
                quantity = f"m per leader over that of the law, bw = {bw_s:g} s"
                text = f"A leader by the {policy} policy is worth more than one by the paper's law"
                claims.append(
                    Claim(text, "beyond the paper", where, quantity, found, runs, least=1.0)
                )
    same = {"n_boats": 27, "bw_s": NOISES_S[0]}
    one = of(table, policy=LAW, leaders=1, against=0, **same)
    for leaders, against, policy in ((2, 1, LAW), (3, 1, LAW), (1, 2, "learned")):
        both = of(table, policy=policy, leaders=leaders, against=against, **same)
        ours = of(table, policy=policy, leaders=1, against=0, **same)
        if min(len(one), len(both), len(ours)) < 3:
            continue

        def difference(
            met: np.ndarray, own: np.ndarray, law: np.ndarray, k: int = leaders, c: int = against
        ) -> np.ndarray:
            seen, ours, theirs = (each[..., 0].mean(-1) for each in (met, own, law))
            return np.asarray((seen - (k * ours - c * theirs)) / theirs)

        claims.append(
            Claim(
                "Two groups with opposite targets respond as q1·k1 − q2·k2",
                "beyond the paper",
                f"{reading}, n = 27, {leaders} {policy} against {against} law",
                f"m less the sum, in the paper's leaders, bw = {NOISES_S[0]:g} s",
                bca([both, ours, one], difference),
                len(both),
                -0.5,
                0.5,
            )
        )
    base = gain(table, NOISES_S[0])[0]
    for bw_s in NOISES_S[1:]:
        found = gain(table, bw_s)
        scaled = tuple(value / base for value in found)
        claims.append(
            Claim(
                "The response follows the fluctuations of leaderless flocks",
                "beyond the paper",
                f"{reading}, n = 27",
                f"m per leader over n·<m²> at bw = {bw_s:g} s, over the same at {NOISES_S[0]:g} s",
                (scaled[0], scaled[1], scaled[2]),
                len(of(table, policy=LAW, leaders=1, against=0, n_boats=27, bw_s=bw_s)),
                2 / 3,
                1.5,
            )
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the response per leader against noise, and the worth of each policy."""
    with picture(options, "worth") as figure:
        left, right = figure.subplots(1, 2)
        noises = sorted(set(NOISES_S) & set(table.loc[table["n_boats"] == 27, "bw_s"]))
        for place, (policy, color) in enumerate(zip(POLICIES, COLORS, strict=False)):
            known = [b for b in noises if len(of(table, policy=policy, bw_s=b, leaders=1))]
            shift = 0.004 * place
            slopes = [slope(table, policy, 27, b) for b in known]
            if known:
                curve(left, np.array(known) + shift, slopes, color=color, label=policy)
            ratios = [worth(table, policy, 27, b) for b in known]
            if policy != LAW and known:
                curve(right, np.array(known) + shift, ratios, color=color)
        left.set(xlabel="bw (s)", ylabel="m per leader, n = 27")
        right.axhline(1.0, color=COLORS[0])
        right.set(xlabel="bw (s)", ylabel="worth in leaders of the paper's law")
        left.legend()


def script(options: Options) -> None:
    """Make the runs, judge and draw them."""
    table = STUDY.results(options)
    write_claims(options, "worth", judge(table))
    draw(options, table)


if __name__ == "__main__":
    main(script)
