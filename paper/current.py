"""What does the measured current alone do to the loss of order, and to what leaders add?

The preset `experiment` and the best constants of the last fit differ in ten constants; here the
strength of the current alone is exchanged between them.
"""

from typing import Any

import pandas as pd
from claim import Claims, Interval, bca, fall, judging, mean
from fit import MEASURED, PRESET, constants, order_row, simulated
from section4 import LEVELS_S, at
from study import COLORS, SEEDS, Options, Row, Study, curve, main, picture

CANDIDATE = 284
SEEDS_FROM = 74
"""Neither fit has seen these seeds."""
CURRENTS = {
    "preset's current": constants(PRESET)["current_gain"],
    "measured current": MEASURED["current_gain"],
}
SETS = {"preset": PRESET, "fitted": CANDIDATE}
ARMS = [(name, current) for current in ("measured current", "preset's current") for name in SETS]
LEADERS = (0, 3)


def design() -> list[Row]:
    """Return 720 runs of 8 minutes for each set of constants with each current."""
    return [
        {"preset": "experiment", "set": name, "current": current}
        | {**constants(SETS[name]), "current_gain": CURRENTS[current]}
        | {"n_leaders": leaders, "bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for name, current in ARMS
        for seed in range(SEEDS_FROM, SEEDS_FROM + SEEDS)
        for leaders in LEADERS
        for bw_s in LEVELS_S
    ]


def measure(row: Row) -> Row:
    """Return the order of a run."""
    found = order_row(simulated(row))
    return {name: found[name] for name in ("psi_o", "abs_m", "m", "jammed")}


STUDY = Study("current", design, measure)


def groups(table: pd.DataFrame, name: str, current: str, leaders: int) -> list[Any]:
    """Return Ψ_o and |m| of the runs of an arm at each noise."""
    runs = table[(table["set"] == name) & (table["current"] == current)]
    return at(runs[runs["n_leaders"] == leaders], "psi_o", "abs_m")


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the current alone moves, in both sets of constants.

    Written before the runs: the current alone explains what leaders add if it raises the shift of
    the loss of order by three leaders in both sets, and it brings flocks without leaders nearer to
    the paper if it moves their loss of order towards 1.4 s.
    """
    claims = Claims("4.3", "")
    levels = sorted(table["bw_s"].unique())
    for name in SETS:
        claims.reading = f"{name} constants, narrow, n = 27"
        arms = {current: [groups(table, name, current, k) for k in LEADERS] for current in CURRENTS}
        if any(len(each) != len(levels) for arm in arms.values() for each in arm):
            continue
        for current, (free, led) in arms.items():
            for k, drawn in zip(LEADERS, (free, led), strict=True):
                claims.add(
                    f"Order is lost around bw = {'2.0' if k else '1.4'} s with {k} leaders",
                    f"critical bw (s), {current}, k = {k}",
                    bca(drawn, lambda *d: fall(levels, d)),
                    least=1.8 if k else 1.2,
                    most=2.2 if k else 1.6,
                )
            claims.add(
                "Three leaders raise the noise at which order is lost",
                f"critical bw with 3 leaders minus without (s), {current}",
                bca([*led, *free], _shift(levels)),
                least=0.0,
            )
        weak, strong = (arms[current] for current in CURRENTS)
        claims.add(
            "The measured current alone moves the loss of order without leaders",
            "critical bw (s), k = 0, measured minus preset's current; read as up",
            bca([*strong[0], *weak[0]], _shift(levels)),
            least=0.0,
        )
        claims.add(
            "The measured current alone raises what leaders add",
            "shift of the critical bw by 3 leaders (s), measured minus preset's current",
            bca([*strong[1], *strong[0], *weak[1], *weak[0]], _change(levels)),
            least=0.0,
        )
    return claims


def _shift(levels: list[float]) -> Any:
    def of(*drawn: Any) -> Any:
        return fall(levels, drawn[: len(levels)]) - fall(levels, drawn[len(levels) :])

    return of


def _change(levels: list[float]) -> Any:
    half, shift = 2 * len(levels), _shift(levels)
    return lambda *drawn: shift(*drawn[:half]) - shift(*drawn[half:])


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw Ψ_o against noise: a panel for each set and number of leaders."""
    with picture(options, "current", height_cm=9.0) as figure:
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for row, name in zip(panels, SETS, strict=True):
            for axes, leaders in zip(row, LEADERS, strict=True):
                for color, marker, current in zip(COLORS, "os", CURRENTS, strict=False):
                    found: list[Interval] = [
                        mean(runs[:, 0]) for runs in groups(table, name, current, leaders)
                    ]
                    if len(found) == len(LEVELS_S):
                        style = {"color": color, "marker": marker, "label": current}
                        curve(axes, LEVELS_S, found, **style)
                axes.axvline(2.0 if leaders else 1.4, color="0.6", linestyle="--", zorder=0)
                axes.set_title(f"{name} constants, {leaders} leaders")
            row[0].set_ylabel("mean Ψ_o")
        for axes in panels[1]:
            axes.set_xlabel("bw (s); dashed: where the paper has order lost")
        panels[0, 0].legend()


script = judging("current", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
