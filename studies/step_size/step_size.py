"""Where the step changes nothing: order and leaders with three physics against dt = 0.005 s.

Written before the runs. 1800 seeds, each with the physics of trainings, the default one, that for
publications, and the reference: 20 and 27 boats in `wide` and 27 in `narrow`, without leaders and
with three that steer by each law, near the noise at which order is lost, for 8 minutes. A quantity
is the mean over the analysis window after the first tenth of a run: Ψ_o and C_v / v0² without
leaders, the signed order with them. Its error is the mean difference from the reference with the
same seed, which has the same start and other noise.

A physics is *inside* if the whole 95 % interval of the error lies within ±0.01: two one-sided tests
at 2.5 % each. It has a *bias*, of the sign of the mean, if the interval reaches beyond ±0.01 and
does not hold 0. Everything else is *undecided*, with the number of its seeds.

How far a physics moves the noise at which order is lost follows from the same runs: with the
reference Ψ_o has some value at a flock's bw_s, and with another physics it falls through that value
at a noise that differs by minus the error of Ψ_o over the slope of Ψ_o. The slope is that between
0.04 s less and 0.04 s more, with the physics of trainings, in 600 other seeds of flocks without
leaders. This shift is inside if its interval lies within ±0.02 s, and is not stated where the
interval of the slope holds 0. Power: the means of 110 runs scatter by 0.14 to 0.20, so that a slope
of -1.2 per s, that between order and disorder in `wide`, has a half width of 0.2, and a shift one
of 0.01 s. This was written after those 110 seeds, and before a run at another noise.
"""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from numpy.typing import NDArray

from studies.claim import Claims, Interval, bca, mean, unknown, write_claims
from studies.picture import COLORS, picture
from studies.study import Options, Row, Study, main, simulated

FIRST = 20_000  # Seeds that no other study of this folder has.
SEEDS = 1800
BOUND = 0.01
REFERENCE = "reference"
#: dt_s and tolerance_cm.
PHYSICS = {
    REFERENCE: (0.005, 1e-6),
    "training": (0.1, 1e-4),
    "default": (0.02, 1e-4),
    "publication": (0.01, 1e-6),
}
#: Pool, number of boats, and bw_s.
FLOCKS = (("wide", 20, 0.31), ("wide", 27, 0.31), ("narrow", 27, 0.45))
NOBODY = "no leaders"
LAWS = ("paper's law", "damped law", "tuned law")
SLOPE_SEEDS = range(22_000, 22_600)  # No other study has these, either.
AWAY_S = 0.04
SHIFT_S = 0.02
QUANTITIES = {"psi_o": "Ψ_o", "c_v": "C_v / v0²", "signed_order": "signed order"}
LABELS = QUANTITIES | {"bw_s": "noise of the same Ψ_o"}
SHIFT = "noise of the same Ψ_o"


def design() -> list[Row]:
    """Return the runs, all of a seed one after another."""
    return [
        {"pool": pool, "n_boats": n_boats, "bw_s": bw_s, "leaders": leaders, "physics": physics}
        | {"dt_s": dt_s, "tolerance_cm": tolerance_cm, "minutes": 8.0, "seed": seed}
        for seed in range(FIRST, FIRST + SEEDS)
        for (pool, n_boats, bw_s), leaders in itertools.product(FLOCKS, (NOBODY, *LAWS))
        for physics, (dt_s, tolerance_cm) in PHYSICS.items()
    ]


def slope_design() -> list[Row]:
    """Return the runs beside each flock's noise, all of a seed one after another."""
    dt_s, tolerance_cm = PHYSICS["training"]
    return [
        {"pool": pool, "n_boats": n_boats, "bw_s": round(bw_s + away_s, 3), "away_s": away_s}
        | {"leaders": NOBODY, "dt_s": dt_s, "tolerance_cm": tolerance_cm, "minutes": 8.0}
        | {"seed": seed}
        for seed in SLOPE_SEEDS
        for pool, n_boats, bw_s in FLOCKS
        for away_s in (-AWAY_S, AWAY_S)
    ]


def measure(row: Row) -> Row:
    """Return the quantities of a run."""
    is_led = row["leaders"] != NOBODY
    policy = row["leaders"] if is_led else None
    run = simulated(row | {"n_leaders": 3 * is_led}, sample_hz=10.0, policy=policy)
    order = run.analyzed().order
    found = (order.psi_o, order.c_v / run.parameters.speed_cm_s**2, order.rotation())
    return {name: each.mean() for name, each in zip(QUANTITIES, found, strict=True)}


STUDY = Study("step_size/step_size", design, measure)
SLOPES = Study("step_size/slopes", slope_design, measure)


def answer(error: Interval, bound: float = BOUND) -> str:
    """Return what the rule says of an error."""
    _, low, high = error
    if low >= -bound and high <= bound:
        return "inside"
    return "undecided" if low <= 0.0 <= high or np.isnan(low) else "bias"


Errors = Iterator[tuple[str, str, str, Interval]]
"""A quantity's name, the flock and the physics, and the error."""


def differences(runs: pd.DataFrame, name: str) -> Iterator[tuple[str, pd.Series]]:
    """Return each physics of a flock with its differences from the reference, by seed."""
    found = runs.pivot(index="seed", columns="physics", values=name)
    for physics in [each for each in PHYSICS if each in found and each != REFERENCE]:
        yield physics, (found[physics] - found[REFERENCE]).dropna()


def errors(table: pd.DataFrame) -> Errors:
    """Return the error of every quantity."""
    cells = table.groupby(["pool", "n_boats", "leaders"], sort=False)
    for (pool, n_boats, leaders), runs in cells:
        for name in ("psi_o", "c_v") if leaders == NOBODY else ("signed_order",):
            for physics, found in differences(runs, name):
                yield name, f"{n_boats:g} boats in {pool}, {leaders}", physics, mean(found)


def shifts(table: pd.DataFrame, slopes: pd.DataFrame) -> Errors:
    """Return how far each physics moves the noise at which order is lost."""
    alone = table[table["leaders"] == NOBODY]
    for (pool, n_boats), runs in alone.groupby(["pool", "n_boats"], sort=False):
        own = slopes[(slopes["pool"] == pool) & (slopes["n_boats"] == n_boats)]
        sides = own.pivot(index="seed", columns="away_s", values="psi_o")
        slope = ((sides[AWAY_S] - sides[-AWAY_S]) / (2 * AWAY_S)).dropna()
        _, low, high = mean(slope)
        for physics, found in differences(runs, "psi_o"):
            groups = [found.to_numpy()[:, None], slope.to_numpy()[:, None]]
            shift = unknown(len(found)) if low <= 0.0 <= high else bca(groups, _shift)
            yield "bw_s", f"{n_boats:g} boats in {pool}, {NOBODY}", physics, shift


def _shift(error: NDArray[np.float64], slope: NDArray[np.float64]) -> NDArray[np.float64]:
    return -error[..., 0].mean(-1) / slope[..., 0].mean(-1)


def judge(table: pd.DataFrame, slopes: pd.DataFrame) -> Claims:
    """Judge every error, and print what the rule says of it."""
    claims = Claims("beyond the paper", "", ours=True)
    for name, flock, physics, error in [*errors(table), *shifts(table, slopes)]:
        dt_s, _ = PHYSICS[physics]
        claims.reading = f"{flock}, physics {physics}"
        quantity = f"{LABELS[name]} at dt = {dt_s:g} s minus that at 0.005 s"
        bound = SHIFT_S if name == "bw_s" else BOUND
        claims.add("The step changes nothing", quantity, error, least=-bound, most=bound)
        value, low, high = error
        print(
            f"{answer(error, bound):9}  {LABELS[name]}, {claims.reading}: "
            f"{value:+.4f} ({low:+.4f} to {high:+.4f}), {error.runs} seeds"
        )
    return claims


def draw(options: Options, table: pd.DataFrame, slopes: pd.DataFrame) -> None:
    """Draw every error with its interval, and the bound."""
    with picture(options, "step_size", height_cm=18.0) as figure:
        first, second = figure.subplots(2, height_ratios=(5, 1))
        _draw(first, [*errors(table)], BOUND)
        _draw(second, [*shifts(table, slopes)], SHIFT_S)
        first.set_xlabel("difference from dt = 0.005 s")
        second.set_xlabel("difference from dt = 0.005 s (s)")
        first.legend(loc="lower center", bbox_to_anchor=(0.3, 1.0), ncols=3)


def _draw(axes: Axes, found: Sequence[tuple[str, str, str, Interval]], bound: float) -> None:
    lines = list(dict.fromkeys((name, flock) for name, flock, *_ in found))
    compared = [physics for physics in PHYSICS if physics != REFERENCE]
    axes.axvspan(-bound, bound, color="0.9")
    axes.axvline(0.0, color="0.5", linewidth=0.6)
    for color, place, physics in zip(COLORS, (-0.25, 0.0, 0.25), compared, strict=False):
        own = {(name, flock): error for name, flock, each, error in found if each == physics}
        value, low, high = np.array(list(own.values())).T
        bars = np.nan_to_num([value - low, high - value])
        heights = [lines.index(line) + place for line in own]
        axes.errorbar(value, heights, xerr=bars, fmt="o", color=color, label=physics)
    names = [f"{LABELS[name]}, {flock}" for name, flock in lines]
    axes.set_yticks(range(len(lines)), names)
    axes.set_ylim(len(lines) - 0.5, -0.5)
    axes.locator_params("x", nbins=6)


def script(options: Options) -> None:
    """Make the runs that are missing, judge and draw them."""
    table, slopes = (study.results(options) for study in (STUDY, SLOPES))
    write_claims(options, "step", judge(table, slopes))
    draw(options, table, slopes)


if __name__ == "__main__":
    main(script)
