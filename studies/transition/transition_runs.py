"""The runs of the transition map: flocks followed from one jam and from rotation."""

import math
from typing import Any

import numpy as np
from scipy import stats

from flockenv.statistics.structure import jam_sizes
from studies.flocks import one_jam, rotating
from studies.study import FIRST_SEED, Row, Study, flock

RUNS, MORE_RUNS = 8, 24
"""Seeds of each cell, and of those cells in which both states may last."""
LITERAL_C4 = 0.1 * math.sqrt(0.02)
"""White noise as strong as the literal one of Table 3 at dt = 0.02 s, in rad/s^1.5."""
C4 = (round(LITERAL_C4, 4), 0.1, 0.03, 0.05, 0.02, 0.2)
COVERAGES = (0.5, 0.3, 0.4, 0.7, 0.2, 1.0)
"""Of the whole map; at the lowest noise 0.35 and 0.25 are added."""
WHITE: Row = {"scheme": "leapfrog", "noise_scheme": "white", "dt_s": 0.1}
STARTED = {"one-jam": "in one jam", "rotating": "rotating"}
_STARTS = {"one-jam": one_jam, "rotating": rotating}

_EVERY_CYCLES = 5
_HELD = 3
"""Samples in a row that make an exit: one minute."""
AFTER_MIN = 20.0
"""How long a flock is followed after it has left its start."""


def outer_radius_cm(n_boats: int, coverage: float) -> float:
    """Return the radius of the pool on whose outer wall n/coverage boats fit in one row.

    They face outward side by side and touch at their sterns, which are 10 cm from the wall.
    """
    return 10.0 + 5.0 / math.sin(math.pi * coverage / n_boats)


def design() -> list[Row]:
    """Return the map, small flocks first.

    Between 0.25 and 0.4 at the lowest noise, and at 0.3 and c4 = 0.03, both states may last in
    flocks of up to 400: there are more runs. A finer step is run at 0.5.
    """
    cells = [
        (n, coverage, WHITE | {"c4": c4})
        for n in (100, 200, 400, 800)
        for coverage in (*COVERAGES, 0.35, 0.25)
        for c4 in (C4 if coverage in COVERAGES else C4[:1])
        if n < 800 or (coverage <= 0.5 and c4 == C4[0]) or (coverage, c4) == (0.5, 0.1)
    ]
    cells += [(n, 0.5, WHITE | {"c4": C4[0], "dt_s": 0.02}) for n in (100, 200)]
    return [
        _row(noise, n, coverage, start, seed)
        for n, coverage, noise in cells
        for seed in range(MORE_RUNS if _both_may_last(n, coverage, noise["c4"]) else RUNS)
        for start in STARTED
    ]


def literal_design() -> list[Row]:
    """Return runs with the literal noise, at three coverages and sizes."""
    literal = {"scheme": "paper", "noise_scheme": "per-step", "dt_s": 0.02, "c4": 0.1}
    return [
        _row(literal, n, coverage, start, seed)
        for n in (100, 200, 400)
        for coverage in (0.5, 0.3, 0.7)
        for seed in range(RUNS)
        for start in STARTED
    ]


def _row(
    noise: Row, n: int, coverage: float, start: str, seed: int, minutes: float = 120.0, **more: Any
) -> Row:
    row = {**noise, "n_boats": n, "coverage": coverage, "start": start, "minutes": minutes}
    return row | more | {"seed": seed}


def _both_may_last(n_boats: int, coverage: float, c4: float) -> bool:
    near = 0.25 <= coverage <= 0.4 if c4 == C4[0] else (coverage, c4) == (0.3, 0.03)
    return near and n_boats <= 400


def measure(row: Row) -> Row:
    """Follow a flock without backing until 20 min after it has left its start, or to the end.

    A row may say that it is followed for longer than that.

    A flock in one jam leaves it when its largest jam has fewer than half of the boats for a minute;
    a rotating one stops when |m|, averaged over a minute, is below 0.4.
    """
    outer = outer_radius_cm(row["n_boats"], row["coverage"])
    parameters = flock(row, bw_s=0.0, pool=(outer, outer * 97.0 / 180.0))
    boats = _STARTS[row["start"]](parameters, FIRST_SEED + row["seed"])
    cycle_s = parameters.fw_s + parameters.nop1_s + parameters.nop2_s
    boats.advance(1.5)  # Into the analysis window.
    samples: list[tuple[float, float, float, float, float, float]] = []
    exit_min = math.nan
    while boats.time_s < 60.0 * row["minutes"]:
        order = boats.order_parameters()
        sizes = jam_sizes(parameters, boats.pose[None])[0]
        minutes = boats.time_s / 60.0
        largest = sizes.max(initial=0) / parameters.n_boats
        jams = (sizes.sum() / parameters.n_boats, largest, len(sizes))
        m, outward = order.psi_o * math.sin(order.phi_o), order.psi_o * math.cos(order.phi_o)
        samples.append((minutes, m, outward, *jams))
        last = np.array(samples[-_HELD:])
        if math.isnan(exit_min) and len(last) == _HELD:
            left = (
                (last[:, 4] < 0.5).all()
                if row["start"] == "one-jam"
                else abs(last[:, 1].mean()) < 0.4
            )
            exit_min = last[0, 0] if left else math.nan
        if minutes > exit_min + row.get("after_min", AFTER_MIN):
            break
        boats.advance(_EVERY_CYCLES * cycle_s)
    return _summary(np.array(samples), exit_min)


def _summary(samples: np.ndarray, exit_min: float) -> Row:
    minutes = samples[:, 0]
    late = samples[minutes > minutes[-1] - 10.0].mean(axis=0)
    before = samples[~(minutes >= exit_min)]
    steady = before[before[:, 0] > 10.0]
    drift = stats.linregress(steady[:, 0], steady[:, 4]).slope if len(steady) > 10 else math.nan
    return {
        "exited": int(math.isfinite(exit_min)),
        "stayed_min": exit_min if math.isfinite(exit_min) else minutes[-1],
        "m": late[1],
        "outward": late[2],
        "in_jams": late[3],
        "largest": late[4],
        "jams": late[5],
        "largest_before": before[:, 4].mean() if len(before) else math.nan,
        "drift_per_h": 60.0 * drift,
    }


def long_design() -> list[Row]:
    """Return runs near the line at the lowest noise, followed for two hours after a split."""
    return [
        _row(WHITE | {"c4": C4[0]}, n, coverage, start, MORE_RUNS + seed, 240.0, after_min=120.0)
        for n in (100, 200, 400, 800)
        for seed in range(RUNS)
        for coverage in (0.25, 0.3, 0.2)
        for start in STARTED
    ]


LITERAL = Study(
    "transition/transition_literal", literal_design, measure, lambda row: row["n_boats"] == 100
)
LONG = Study("transition/transition_long", long_design, measure, lambda row: row["n_boats"] == 100)
STUDY = Study(
    "transition/transition",
    design,
    measure,
    lambda row: row["coverage"] == 0.5 and row["n_boats"] <= 200,
)
