"""Which flocks need noise to move? The rise of |m| by noise against the density of boats."""

import math

import numpy as np
import pandas as pd
from claim import Claims, Interval, bca, judging
from fit import constants
from section5 import READINGS
from starts import RADII_CM
from study import COLORS, SEEDS, Options, Row, Study, curve, flock, main, order_row, picture
from study import simulated as run_of

BOATS, POOLS = (20, 27, 50), ("wide", "narrow")
FIRST = 100
"""Seeds that no other study of this folder has."""
LEAST_RISE = 0.3
CANDIDATE = 284
"""The best constants of the last fit, which hold the measured current."""

_LOW = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
_WIDER = (0.0, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)
SETS: dict[str, tuple[Row, tuple[float, ...]]] = {
    "simulation": ({"preset": "simulation"}, _LOW),
    "paper": ({"preset": "paper"}, _LOW),
    "experiment": ({"preset": "experiment"}, _WIDER),
    "measured current": ({"preset": "experiment", **constants(CANDIDATE)}, _WIDER),
}
"""Constants and noises up to the one where rotation is at its best, by name."""
_NAMED = sorted({name for row, _ in SETS.values() for name in row} - {"preset"})


def design() -> list[Row]:
    """Return runs of 16 minutes without leaders."""
    rows = []
    for name, (given, noises) in SETS.items():
        known = flock(given).to_dict()
        rows += [
            {
                "set": name,
                "preset": given["preset"],
                **{field: known[field] for field in _NAMED},
                "pool": pool,
                "n_boats": n,
                "n_leaders": 0,
                "bw_s": bw_s,
                "minutes": 16.0,
                "seed": seed,
            }
            for n in BOATS
            for pool in POOLS
            for bw_s in noises
            for seed in range(FIRST, FIRST + SEEDS)
        ]
    return sorted(rows, key=lambda row: row["n_boats"] != 27)


def measure(row: Row) -> Row:
    """Return order and jams of a run."""
    found = order_row(run_of(row, sample_hz=4.0))
    return {name: found[name] for name in ("psi_o", "abs_m", "jammed")}


STUDY = Study("density", design, measure, lambda row: row["bw_s"] in (0.0, 0.4))


def rise(runs: pd.DataFrame) -> Interval:
    """Return mean |m| at the noise where it is largest minus that without noise."""
    groups = [each[["abs_m"]].to_numpy() for _, each in runs.groupby("bw_s")]

    def of(*drawn: np.ndarray) -> np.ndarray:
        means = np.stack(np.broadcast_arrays(*(each[..., 0].mean(-1) for each in drawn)))
        return np.asarray(means.max(0) - means[0])

    return bca(groups, of)


def covered(pool: str, n_boats: int) -> float:
    """Return the share of the water that hulls cover."""
    p = flock(READINGS["simulation"], pool=pool)
    outer, inner = RADII_CM[pool]
    hull = (math.pi + 4.0 * p.boat_shape) * p.boat_radius_cm**2
    return n_boats * hull / (math.pi * (outer**2 - inner**2))


def judge(table: pd.DataFrame) -> Claims:
    """Judge whether noise makes motion, in each pool and number of boats."""
    claims = Claims("6", "")
    for (name, pool, n), runs in table.groupby(["set", "pool", "n_boats"], sort=False):
        claims.reading = f"{name}, {pool}"
        claims.add(
            "Some noise is needed for long-term ordered motion",
            "largest mean |m| of any noise minus that at bw = 0, no leaders; "
            f"read as at least {LEAST_RISE:g}",
            rise(runs),
            least=LEAST_RISE,
            n=f"{n:g}",
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the rise, and |m| without noise, against the share of the water under hulls."""
    with picture(options, "density", height_cm=7.0) as figure:
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        for color, marker, name in zip(COLORS, "osD^", SETS, strict=False):
            cells = {
                100 * covered(pool, n): table[
                    (table["set"] == name) & (table["pool"] == pool) & (table["n_boats"] == n)
                ]
                for pool in POOLS
                for n in BOATS
            }
            cells = {x: runs for x, runs in cells.items() if len(runs)}
            style = {"color": color, "marker": marker, "label": name, "linewidth": 0.6}
            if cells:
                curve(left, cells, [rise(runs) for runs in cells.values()], **style)
                quiet = [runs[runs["bw_s"] == 0.0]["abs_m"].to_numpy() for runs in cells.values()]
                curve(right, cells, [bca([q[:, None]], _mean) for q in quiet], **style)
        left.axhline(LEAST_RISE, color="0.6", linestyle="--", linewidth=0.6)
        left.set(ylabel="rise of mean |m| by noise", ylim=(-0.03, 1.0))
        right.set(ylabel="mean |m| without noise", ylim=(-0.03, 1.0))
        for axes in (left, right):
            axes.set_xlabel("share of the water under hulls (%)\nwide: 4, 5, 9; narrow: 14, 19, 36")
        right.legend()


def _mean(drawn: np.ndarray) -> np.ndarray:
    return np.asarray(drawn[..., 0].mean(-1))


script = judging("density", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
