"""What is a leader worth? The flock's response to a few leaders, in units of the paper's law.

The rule of the answer stands in README.md and was committed before the first run.
"""

from typing import Any

import numpy as np
import pandas as pd

from flockenv.comparison.figure import policy_colors
from studies.claim import Claims, Interval, bca, judging, mean, unknown
from studies.picture import curve, picture
from studies.study import Options, main
from studies.worth.worth_runs import LAW, NOISES_S, POLICIES, STUDY


def of(table: pd.DataFrame, **values: Any) -> np.ndarray:
    """Return m and m² of the runs with these values, shape (runs, 2)."""
    chosen = table
    for name, value in values.items():
        chosen = chosen[chosen[name] == value]
    return chosen[["m", "m_squared"]].to_numpy()


def slope(table: pd.DataFrame, policy: str, n_boats: int, bw_s: float) -> Interval:
    """Return the flock's response per leader, by the fewest leaders that were run."""
    leaders = LEADERS[n_boats]
    runs = of(table, policy=policy, n_boats=n_boats, bw_s=bw_s, leaders=leaders, against=0)
    value, low, high = mean(runs[:, 0])
    return Interval((value / leaders, low / leaders, high / leaders), len(runs))


LEADERS = {27: 1, 100: 4, 400: 15}
"""The fewest leaders that were run, by number of boats."""


def pair(table: pd.DataFrame, n_boats: int, bw_s: float) -> Interval:
    """Return by how much the learned leaders shift m more than the tuned law, in the same noise."""
    runs = table[(table["n_boats"] == n_boats) & (table["bw_s"] == bw_s) & (table["against"] == 0)]
    runs = runs[runs["leaders"] == LEADERS[n_boats]]
    m = runs.pivot_table(index="seed", columns="policy", values="m")
    if not {"learned", "tuned law"} <= set(m):
        return unknown()
    return mean((m["learned"] - m["tuned law"]).dropna())


def worth(table: pd.DataFrame, policy: str, n_boats: int, bw_s: float) -> Interval:
    """Return a policy's response over that of the law, with as many leaders.

    NaN where the interval of the law's response includes 0.
    """
    leaders = LEADERS[n_boats]
    same = {"n_boats": n_boats, "bw_s": bw_s, "leaders": leaders, "against": 0}
    groups = [of(table, policy=name, **same) for name in (policy, LAW)]
    if min(map(len, groups)) < 3 or not mean(groups[1][:, 0])[1] > 0.0:
        return unknown()
    return bca(groups, lambda ours, theirs: ours[..., 0].mean(-1) / theirs[..., 0].mean(-1))


def gain(table: pd.DataFrame, bw_s: float) -> Interval:
    """Return the law's response per leader over n·<m²> without leaders, in units of that at 0.31 s.

    The interval is over the runs of both noises.
    """
    groups = [
        of(table, n_boats=27, bw_s=noise, policy=LAW, against=0, leaders=leaders)
        for noise in (bw_s, NOISES_S[0])
        for leaders in (1, 0)
    ]
    if min(map(len, groups)) < 3:
        return unknown()

    def ratio(led: Any, free: Any, led_there: Any, free_there: Any) -> Any:
        here = led[..., 0].mean(-1) / free[..., 1].mean(-1)
        return here / (led_there[..., 0].mean(-1) / free_there[..., 1].mean(-1))

    return bca(groups, ratio)


def judge(table: pd.DataFrame) -> Claims:
    """Judge worth, additivity and the response against the fluctuations."""
    claims = Claims("beyond the paper", "simulation (leapfrog, white), wide", ours=True)
    for n_boats, bw_s in [(27, bw_s) for bw_s in NOISES_S] + [(100, 0.31), (400, 0.31)]:
        for policy in POLICIES[1:]:
            same = {"n_boats": n_boats, "bw_s": bw_s, "against": 0}
            if len(of(table, policy=policy, **same)):
                claims.add(
                    f"A leader by the {policy} policy is worth more than one by the paper's law",
                    f"m per leader over that of the law, bw = {bw_s:g} s",
                    worth(table, policy, n_boats, bw_s),
                    least=1.0,
                    n=str(n_boats),
                )
        claims.add(
            "A leader by the learned policy shifts m more than one by the tuned law",
            f"m, learned minus tuned law, paired by seed, bw = {bw_s:g} s",
            pair(table, n_boats, bw_s),
            least=0.0,
            n=str(n_boats),
        )
    same = {"n_boats": 27, "bw_s": NOISES_S[0]}
    one = of(table, policy=LAW, leaders=1, against=0, **same)
    two = of(table, policy=LAW, leaders=2, against=0, **same)
    claims.add(
        "Two leaders with one target respond as twice one leader",
        "m with two leaders less twice that with one, in the paper's leaders, "
        f"bw = {NOISES_S[0]:g} s",
        bca([two, one], lambda both, each: both[..., 0].mean(-1) / each[..., 0].mean(-1) - 2.0),
        least=-0.5,
        most=0.5,
        n="27",
    )
    for leaders, against, policy in ((2, 1, LAW), (3, 1, LAW), (1, 2, "learned")):
        both = of(table, policy=policy, leaders=leaders, against=against, **same)
        ours = of(table, policy=policy, leaders=1, against=0, **same)
        if min(map(len, (one, both, ours))) < 3:
            continue

        def difference(met: Any, own: Any, law: Any, k: int = leaders, c: int = against) -> Any:
            seen, ours, theirs = (each[..., 0].mean(-1) for each in (met, own, law))
            return (seen - (k * ours - c * theirs)) / theirs

        claims.add(
            "Two groups with opposite targets respond as q1·k1 − q2·k2",
            f"m less the sum, in the paper's leaders, {leaders} by the {_named(policy)} policy "
            f"against {against} by the paper's law, bw = {NOISES_S[0]:g} s",
            bca([both, ours, one], difference),
            least=-0.5,
            most=0.5,
            n="27",
        )
    for bw_s in NOISES_S[1:]:
        claims.add(
            "The response follows the fluctuations of leaderless flocks",
            f"m per leader over n·<m²> at bw = {bw_s:g} s, over the same at {NOISES_S[0]:g} s",
            gain(table, bw_s),
            least=2 / 3,
            most=1.5,
            n="27",
        )
    return claims


def _named(policy: str) -> str:
    return {LAW: "paper's law"}.get(policy, policy)


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the response per leader against noise, and the worth of each policy."""
    with picture(options, "worth") as figure:
        left, right = figure.subplots(1, 2)
        noises = sorted(set(NOISES_S) & set(table.loc[table["n_boats"] == 27, "bw_s"]))
        colors = policy_colors(map(_named, POLICIES))
        for place, (policy, color) in enumerate(zip(POLICIES, colors.values(), strict=True)):
            known = [b for b in noises if len(of(table, policy=policy, bw_s=b, leaders=1))]
            shift = 0.004 * place
            slopes = [slope(table, policy, 27, b) for b in known]
            if known:
                curve(left, np.array(known) + shift, slopes, color=color, label=_named(policy))
            ratios = [worth(table, policy, 27, b) for b in known]
            if policy != LAW and known:
                curve(right, np.array(known) + shift, ratios, color=color)
        left.set(xlabel="bw (s)", ylabel="m per leader, n = 27")
        right.axhline(1.0, color=colors[_named(LAW)])
        right.set(xlabel="bw (s)", ylabel="worth in leaders of the paper's law")
        left.legend()


script = judging("worth", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
