"""The experiment's constants fitted once more, with what the paper measured held fixed.

The fitted constants and the preset differ in ten numbers; so the strength of the current alone is
exchanged between them, too. The current is that of `current_gain`: water that moves against the
mean tangential velocity of the flock at that instant, in proportion to it, at every radius and
without inertia. The paper's water had inertia, so this is not the current that it measured.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from studies.claim import DISORDER, Claims, bca, disorder, fall, mean, write_claims
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.section4.section4 import LEVELS_S, at
from studies.study import SEEDS, Options, Row, Study, main, simulated

MEASURED: Row = {
    "speed_spread_cm_s": 5.0,
    "current_gain": 0.32,
    "current_cap_cm_s": 5.0,
    "leader_speed_factor": 1.0,
}
"""What the paper reports: speeds of 15 ± 5 cm/s (Table 1), a current of 3 to 5 cm/s where boats
have 10 to 15 cm/s, whose middles have the ratio 0.32 (Section 4.5), and leaders as fast as the
others (Section 2.6). It gives no number for the bias, which stays that of the preset."""
RANGES = {
    "speed_cm_s": (15.0, 22.0),
    "reverse_speed_cm_s": (3.0, 15.0),
    "c0": (0.3, 3.0),
    "c2": (0.1, 1.0),
    "c3": (0.05, 1.0),
    "c4": (0.01, 0.2),
}
"""Where the other constants are drawn, equal ratios with equal chances. c1 follows from them: a
backing boat turns at w = ±1 rad/s (Table 1), where c1·w² = c3·v·c0²/(c0² + w²) (eqs. 8 and 9)."""
CANDIDATES, BEST, PRESET = 480, 12, -1
"""Candidates that are drawn and that are fitted, and the number of the preset among them."""
SCREENED_S = tuple(round(0.4 * place, 1) for place in range(8))
SCREENING, FITTING = range(2), range(2, 2 + SEEDS)
HELD_OUT = range(2 + 2 * SEEDS, 2 + 3 * SEEDS)
"""Seeds; no choice depends on the last. Those between were the held-out ones of a first fit of 240
candidates without the target of jams; its best, 83, lost order at 1.52 and 1.85 s and jammed less.
"""

# What Sections 4.3 and 6 say in numbers, and how far from it counts as one: order is lost at 1.4 s
# without leaders and at 2.0 s with three; Ψ_o is near 1 in order and below 0.3 in disorder; jams
# dominate at very low noise. There is order to lose where |m| reaches 0.5. The caption of figure 9
# says 1.4 and 2.0 s of the density of φ_o, and this fit asks the middle of the fall of Ψ_o for
# them, by mistake: a small misfit is not agreement with the paper.
LOST_S, TOLERANCE_S = {0: 1.4, 3: 2.0}, 0.1
ORDERED, DISORDERED, LEAST_M, TOLERANCE = 0.9, 0.3, 0.5, 0.1
JAMMED = 0.5
"""Least share of jammed frames without leaders at bw = 0, as `noise_makes_motion` reads it."""


def constants(candidate: int) -> Row:
    """Return the constants of a candidate."""
    if candidate == PRESET:
        preset = flockenv.FlockParameters.preset("experiment").to_dict()
        return {name: preset[name] for name in (*MEASURED, *RANGES, "c1")}
    shares = np.random.default_rng(candidate).uniform(size=len(RANGES))
    drawn = {
        name: float(f"{low * (high / low) ** share:.4g}")
        for (name, (low, high)), share in zip(RANGES.items(), shares, strict=True)
    }
    lag = drawn["c0"] ** 2 / (drawn["c0"] ** 2 + 1.0)
    c1 = float(f"{drawn['c3'] * drawn['reverse_speed_cm_s'] * lag:.4g}")
    return MEASURED | drawn | {"c1": c1}


def runs_of(
    options: Options,
    candidates: Iterable[int],
    levels_s: Iterable[float],
    seeds: range,
    optional: bool = False,
) -> pd.DataFrame:
    """Return runs of 8 minutes of candidates, without leaders and with three clockwise ones."""
    rows = [
        {"preset": "experiment", "candidate": candidate, **constants(candidate)}
        | {"n_leaders": leaders, "bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for candidate in candidates
        for seed in (range(2) if options.trial else seeds)
        for leaders in LOST_S
        for bw_s in levels_s
    ]
    return Study("current/fit", lambda: rows, _measure, adaptive=True).results(options, optional)


def _measure(row: Row) -> Row:
    found = order_row(simulated(row))
    return {name: found[name] for name in ("psi_o", "abs_m", "m", "jammed")}


MEANS = ("psi_o", "abs_m", "jammed")


def groups(table: pd.DataFrame, candidate: int) -> list[Any]:
    """Return Ψ_o, |m| and jams of a candidate's runs, by number of leaders and noise."""
    runs = table[table["candidate"] == candidate]
    return [each for k in LOST_S for each in at(runs[runs["n_leaders"] == k], *MEANS)]


def misfit(levels_s: Sequence[float], drawn: Sequence[Any]) -> Any:
    """Return the sum of squared distances from the paper of `groups`, one for each draw."""
    x = np.asarray(levels_s)
    ordered, disordered = (x > 0.75) & (x < 1.25), x > 2.35
    total: Any = 0.0
    for place, lost_s in enumerate(LOST_S.values()):
        runs = drawn[place * len(x) : (place + 1) * len(x)]
        psi_o, abs_m, jammed = (
            np.stack(np.broadcast_arrays(*(each[..., column].mean(-1) for each in runs)))
            for column in range(len(MEANS))
        )
        total = total + ((fall(levels_s, runs) - lost_s) / TOLERANCE_S) ** 2
        for lacking in (
            ORDERED - psi_o[ordered].mean(0),
            psi_o[disordered].mean(0) - DISORDERED,
            LEAST_M - abs_m.max(0),
            *([JAMMED - jammed[0]] if place == 0 else []),
        ):
            total = total + (np.maximum(lacking, 0.0) / TOLERANCE) ** 2
    return total


def best(table: pd.DataFrame, levels_s: Sequence[float], count: int) -> list[int]:
    """Return the candidates with the least misfit, the best first."""
    numbers = [int(number) for number in table["candidate"].unique() if number != PRESET]
    return sorted(numbers, key=lambda each: float(misfit(levels_s, groups(table, each))))[:count]


def judge(table: pd.DataFrame, found: int) -> Claims:
    """Judge the best candidate and the preset on held-out seeds.

    The preset is replaced only where the first claim holds.
    """
    claims = Claims("4.3", f"fitted constants (candidate {found}, white), narrow, n = 27")
    both = [*groups(table, found), *groups(table, PRESET)]
    half = len(both) // 2
    claims.add(
        "Constants with a gain of 0.32 and the measured spread fit better than the preset",
        "misfit of the best candidate minus that of the preset, held-out seeds",
        bca(both, lambda *d: misfit(LEVELS_S, d[:half]) - misfit(LEVELS_S, d[half:])),
        most=0.0,
        ours=True,
    )
    return claims


CANDIDATE = 284
"""The best constants of the fit, with a current of gain 0.32."""
UNSEEN = 74
"""Neither fit has seen these seeds."""
CURRENTS = {
    "gain 0.04": constants(PRESET)["current_gain"],
    "gain 0.32": MEASURED["current_gain"],
}
SETS = {"preset": PRESET, "fitted": CANDIDATE}
ARMS = [(name, current) for current in ("gain 0.32", "gain 0.04") for name in SETS]
LEADERS = (0, 3)


def exchanged() -> list[Row]:
    """Return 720 runs of 8 minutes for each set of constants with each current."""
    return [
        {"preset": "experiment", "set": name, "current": current}
        | {**constants(SETS[name]), "current_gain": CURRENTS[current]}
        | {"n_leaders": leaders, "bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for name, current in ARMS
        for seed in range(UNSEEN, UNSEEN + SEEDS)
        for leaders in LEADERS
        for bw_s in LEVELS_S
    ]


CURRENT = Study("current/current", exchanged, _measure)


def arm(table: pd.DataFrame, name: str, current: str, leaders: int) -> list[Any]:
    """Return Ψ_o and |m| of the runs of an arm at each noise."""
    runs = table[(table["set"] == name) & (table["current"] == current)]
    return at(runs[runs["n_leaders"] == leaders], "psi_o", "abs_m")


def judge_current(table: pd.DataFrame) -> Claims:
    """Judge what the current alone moves, in both sets of constants.

    Written before the runs: the current alone explains what leaders add if it raises the shift of
    the loss of order by three leaders in both sets, and it brings flocks without leaders nearer to
    the paper if it moves their loss of order towards 1.4 s. Written after them: order counts as
    lost where Ψ_o falls through 0.3, as the middle of the fall is ill-defined in the fitted set.
    """
    claims = Claims("4.3", "", ours=True)
    levels = sorted(table["bw_s"].unique())
    for name in SETS:
        claims.reading = f"{name} constants, narrow, n = 27"
        arms = {current: [arm(table, name, current, k) for k in LEADERS] for current in CURRENTS}
        if any(len(each) != len(levels) for arm in arms.values() for each in arm):
            continue
        for current, (free, led) in arms.items():
            for k, drawn in zip(LEADERS, (free, led), strict=True):
                lost_s = LOST_S[k]
                claims.add(
                    f"Ψ_o becomes that of disorder around bw = {lost_s} s",
                    f"bw (s) at which mean Ψ_o falls through {DISORDER:g}, {current}, k = {k}",
                    disorder(levels, [drawn]),
                    least=lost_s - 0.2,
                    most=lost_s + 0.2,
                )
            claims.add(
                "Leaders raise the noise at which Ψ_o becomes that of disorder",
                f"that bw with 3 leaders minus without (s), {current}",
                disorder(levels, [led, free], (1.0, -1.0)),
                least=0.0,
            )
        weak, strong = (arms[current] for current in CURRENTS)
        claims.add(
            "A stronger current alone moves the loss of order without leaders up",
            f"bw (s) at which mean Ψ_o falls through {DISORDER:g}, k = 0, gain 0.32 minus 0.04",
            disorder(levels, [strong[0], weak[0]], (1.0, -1.0)),
            least=0.0,
        )
        claims.add(
            "A stronger current alone raises what leaders add",
            "shift of that bw by 3 leaders (s), gain 0.32 minus 0.04",
            disorder(levels, [*strong[::-1], *weak[::-1]], (1.0, -1.0, -1.0, 1.0)),
            least=0.0,
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw Ψ_o against noise: a panel for each set and number of leaders."""
    with picture(options, "current", height_cm=9.0) as figure:
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for row, name in zip(panels, SETS, strict=True):
            for axes, leaders in zip(row, LEADERS, strict=True):
                for color, marker, current in zip(COLORS, "os", CURRENTS, strict=False):
                    runs = arm(table, name, current, leaders)
                    if len(runs) == len(LEVELS_S):
                        style = {"color": color, "marker": marker, "label": current}
                        curve(axes, LEVELS_S, [mean(each[:, 0]) for each in runs], **style)
                        _, low, high = disorder(LEVELS_S, [runs])
                        axes.axvspan(low, high, color=color, alpha=0.25, lw=0)
                axes.axvline(2.0 if leaders else 1.4, color="0.6", linestyle="--", zorder=0)
                axes.set_title(f"{name} constants, {leaders} leaders")
            row[0].set_ylabel("mean Ψ_o")
        for axes in panels[1]:
            axes.set_xlabel("bw (s)")
        figure.supxlabel("shaded: Ψ_o falls through 0.3; dashed: loss in figure 9")
        panels[0, 0].legend(title="current")


def script(options: Options) -> None:
    """Screen candidates, fit the best of them, and hold the best one against the preset."""
    count = 2 if options.trial else CANDIDATES
    screened = runs_of(options, range(count), SCREENED_S, SCREENING)
    few = best(screened, SCREENED_S, BEST)
    fitted = runs_of(options, few, LEVELS_S, FITTING)
    (found,) = best(fitted, LEVELS_S, 1)
    table = runs_of(options, (found, PRESET), LEVELS_S, HELD_OUT)
    current = CURRENT.results(options)
    write_claims(options, "fit", [*judge(table, found), *judge_current(current)])
    draw(options, current)


if __name__ == "__main__":
    main(script)
