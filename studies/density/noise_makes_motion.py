"""Is noise needed for long-term motion? Rotation and jams against bw, and its rise against density.

27 boats of the preset `experiment` first, as the paper has them; then 20 to 50 boats in both pools.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, bca, mean, write_claims
from studies.current.fit import CANDIDATE, HELD_OUT, LEVELS_S, constants, runs_of
from studies.flocks import RADII_CM
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.section4.section4 import FREE, READING, STUDY, VERY_LOW_S, over, setup, words
from studies.section5.section5 import STUDY as SECTION5
from studies.section5.section5 import Evidence
from studies.study import SEEDS, Options, Row, Study, flock, main
from studies.study import simulated as run_of

FIRST = 100  # Seeds that no other study of this folder has.
LEAST_RISE = 0.3
NOISES_S = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
SETS: dict[str, Row] = {
    "simulation": {"preset": "simulation"},
    "paper": {"preset": "paper"},
    "experiment": {"preset": "experiment"},
    "fitted": {"preset": "experiment", **constants(CANDIDATE)},
}
"""Constants by name; the last are those of `studies.current.fit`."""
_NAMED = sorted({name for row in SETS.values() for name in row} - {"preset"})


def design() -> list[Row]:
    """Return runs of 27 boats for 16 minutes: other numbers are in the runs of Section 5."""
    rows = []
    for name in ("simulation", "paper"):
        known = flock(SETS[name]).to_dict()
        rows += [
            {"set": name, "preset": name, **{field: known[field] for field in _NAMED}}
            | {"pool": pool, "n_boats": 27, "n_leaders": 0, "bw_s": bw_s}
            | {"minutes": 16.0, "seed": seed}
            for pool in RADII_CM
            for bw_s in NOISES_S
            for seed in range(FIRST, FIRST + SEEDS)
        ]
    return sorted(rows, key=lambda row: row["seed"])


def measure(row: Row) -> Row:
    """Return order and jams of a run."""
    found = order_row(run_of(row, sample_hz=4.0))
    return {name: found[name] for name in ("psi_o", "abs_m", "jammed")}


DENSITY = Study("density/density", design, measure, lambda row: row["bw_s"] in (0.0, 0.4))


def rise(runs: pd.DataFrame) -> Interval:
    """Return mean |m| at the noise where it is largest minus that without noise."""
    groups = [each[["abs_m"]].to_numpy() for _, each in runs.groupby("bw_s")]

    def of(*drawn: np.ndarray) -> np.ndarray:
        means = np.stack(np.broadcast_arrays(*(each[..., 0].mean(-1) for each in drawn)))
        return np.asarray(means.max(0) - means[0])

    return bca(groups, of)


def coverage(pool: str, n_boats: int) -> float:
    """Return the number of boats over those that fit in one row on the outer wall.

    They face it side by side and touch at their sterns, which are 10 cm from it.
    """
    return n_boats * math.asin(5.0 / (RADII_CM[pool][0] - 10.0)) / math.pi


def cells(options: Options) -> dict[tuple[str, str, int], pd.DataFrame]:
    """Return the runs without leaders of every set of constants, pool and number of boats.

    Of each cell those of the seeds that have been run at all of its noises.
    """
    tables = {("experiment", "narrow", 27): setup(STUDY.results(options), FREE)}
    there = replace(options, runs=False)
    fitted = runs_of(there, (CANDIDATE,), LEVELS_S, HELD_OUT, optional=True)
    if len(fitted):
        tables["fitted", "narrow", 27] = fitted[fitted["n_leaders"] == 0]
    others = SECTION5.results(replace(options, runs=options.trial), optional=True)
    for name in ("simulation", "paper"):
        for n, pool in itertools.product((20, 50), RADII_CM):
            reading = name if pool == "wide" else f"{name}, narrow"
            tables[name, pool, n] = Evidence(others, reading).of(n, 0)
    for (name, pool, n), runs in DENSITY.results(options).groupby(["set", "pool", "n_boats"]):
        tables[name, pool, int(n)] = runs
    found = {}
    for key, runs in tables.items():
        noises = runs.groupby("seed")["bw_s"].transform("size")
        if len(runs) and runs["bw_s"].nunique() > 3:
            found[key] = runs[noises == noises.max()]
    return found


def judge_density(found: dict[tuple[str, str, int], pd.DataFrame]) -> Claims:
    """Judge whether the noise bw makes motion, in each pool and number of boats.

    The paper simulated 20 and 50 boats in the pool that is called `wide` here.
    """
    claims = Claims("6", "")
    for (name, pool, n), runs in found.items():
        claims.reading = f"{name}, {pool}"
        claims.add(
            "Some noise is needed for long-term ordered motion",
            "largest mean |m| of any noise minus that at bw = 0, no leaders; "
            f"read as at least {LEAST_RISE:g}",
            rise(runs),
            least=LEAST_RISE,
            n=str(n),
            ours=name != "experiment" and (pool != "wide" or n not in (20, 50)),
        )
    return claims


def draw_density(options: Options, found: dict[tuple[str, str, int], pd.DataFrame]) -> None:
    """Draw the rise, and |m| without backing, against the coverage of the outer wall."""
    with picture(options, "density", height_cm=7.0) as figure:
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        for color, marker, name in zip(COLORS, "osD^", SETS, strict=False):
            own = sorted(key[1:] for key in found if key[0] == name)
            walls = {coverage(*key): found[name, *key] for key in own}
            style = {"color": color, "marker": marker, "label": name, "linestyle": ""}
            if walls:
                curve(left, walls, [rise(runs) for runs in walls.values()], **style)
                quiet = [mean(runs[runs["bw_s"] == 0.0]["abs_m"]) for runs in walls.values()]
                curve(right, walls, quiet, **style)
        left.axhline(LEAST_RISE, color="0.6", linestyle="--", linewidth=0.6)
        left.set(ylabel="rise of mean |m| by backing (bw)", ylim=(-0.03, 1.0))
        right.set(ylabel="mean |m| at bw = 0")
        for axes in (left, right):
            axes.set_xlabel("boats over room on the wall\n(wide: 0.19, 0.25, 0.47)")
        right.legend(title="constants")


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the summary says of noise."""
    claims = Claims("6, 4.3", READING)
    free = setup(table, FREE)
    none, some = over(free, "abs_m", 0.0, 0.0), over(free, "abs_m", 1.0, 1.0)
    claims.add(
        "Some noise is needed for long-term ordered motion",
        "mean |m| at bw = 1.0 s minus that at bw = 0, no leaders; read as at least 0.3",
        mean(some - none),
        least=0.3,
    )
    claims.add(
        "Jamming dominates at very low noise",
        f"share of jammed frames, {words(VERY_LOW_S)}, no leaders",
        mean(over(free, "jammed", *VERY_LOW_S)),
        least=0.5,
    )
    claims.add(
        "Too much noise turns ordered motion into disordered motion",
        "mean |m| at bw ≥ 2.0 s over that at 1.0 s, no leaders; read as at most a quarter",
        bca(
            [np.stack([over(free, "abs_m", 2.0), some], 1)],
            lambda drawn: drawn[..., 0].mean(-1) / drawn[..., 1].mean(-1),
        ),
        most=0.25,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw |m| and the share of jammed frames against noise."""
    free = setup(table, FREE)
    with picture(options, "noise_makes_motion", width_cm=12.0, height_cm=6.5) as figure:
        axes = figure.subplots()
        shown = (("abs_m", "o", "rotation, mean |m|"), ("jammed", "s", "share of jammed frames"))
        for color, (column, marker, label) in zip(COLORS, shown, strict=False):
            groups = free.groupby("bw_s")[column]
            found = [mean(each) for _, each in groups]
            curve(axes, groups.groups, found, color=color, marker=marker, label=label)
        axes.set(xlabel="backward duration bw (s)", ylim=(-0.03, 1.0))
        axes.set_title(f"27 boats, no leaders, {free['seed'].nunique()} runs of 8 min per level")
        axes.legend()


def script(options: Options) -> None:
    """Make, judge and draw the runs of both studies."""
    table, found = STUDY.results(options), cells(options)
    write_claims(options, "noise_makes_motion", [*judge(table), *judge_density(found)])
    draw(options, table)
    draw_density(options, found)


if __name__ == "__main__":
    main(script)
