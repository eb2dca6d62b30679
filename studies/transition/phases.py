"""Where do jams and rotation last, at which noise and coverage, and what stays outside of jams?

The design and the rule were written before the runs. Flocks of 200 boats at bw = 0 start in one jam
or rotating, in the rings of `condensation.py`: five white noises, and the literal noise of Table 3.
A map has three seeds of each cell; cells of white c4 = 0.1 and 0.03 that `condensation.py` has are
not made again. Beside it are larger flocks (800 boats, and 1600 at c4 = 0.1 and a coverage of 0.6),
and flocks of 100 and 400 boats with the literal noise.

1. *Both last* at a noise if, at two neighboring coverages together, more than half of the flocks
   from each start are in its state in the third hour, by the whole interval: from one jam at least
   a twentieth of the boats are in jams, and from rotation |m| is at least 0.5. Of all neighbors
   those count in which the rarer state is most frequent: six of six flocks decide it, and none of
   six.
2. *The saturation rises with the noise*: at a coverage of 0.6 more boats stay outside of jams than
   at the next weaker white noise.
3. *In one ring added boats join the jams.* `condensation.py` compares flocks of one size, so that
   the denser flock is in a smaller ring. Twice the boats at twice the coverage are in the same
   ring: of the boats added from a coverage of 0.3 to 0.6 less than a tenth stay outside.
4. The rule of `condensation.py`, at the noises and sizes that it does not have.

Jams are told by gaps and headings. The table of cells has the share of slow boats beside it, those
below half of their full speed, and counts with twice as strict bounds.

Seen after the runs: a flock with some jams may rotate, and then counts for both states. The table
of cells also counts jams only where |m| is below 0.5. Of neighbors that tie the first are named.
The third condition allows a tenth either way, which is more than its words ask, and at white
c4 = 0.1 and 0.03 it is mostly judged by runs of `condensation.py` that were known before it was
written.

Runs come in blocks of a seed of all cells of a size: the map, then larger flocks. They are judged
after as many whole blocks as time allows, whatever they show.
"""

from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, mean, proportion, unknown, write_claims
from studies.picture import COLORS, DENSITIES, curve, picture
from studies.store import write
from studies.study import Options, Row, Study, main
from studies.transition import condensation
from studies.transition.condensation import ADDED, DENSE, HOURS, WIDTH_CM, difference, outside
from studies.transition.outside import JAMS
from studies.transition.transition_runs import LITERAL_C4, STARTED, WHITE

LITERAL: Row = {"scheme": "paper", "noise_scheme": "per-step", "dt_s": 0.02, "c4": 0.1}
NOISES: tuple[Row, ...] = (
    *({**WHITE, "c4": c4} for c4 in (round(LITERAL_C4, 4), 0.03, 0.05, 0.1, 0.2)),
    LITERAL,
)
COVERAGES = (0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6)
BOATS, SEEDS = 200, 3
FIRST = 620  # Seeds that no other study of this folder has.
ROTATES, LASTS = 0.5, 0.5
"""Least |m| of a flock that rotates, and least share of flocks of a state that lasts."""
_MEASURED_BEFORE = [
    ({**WHITE, "c4": c4}, coverage) for c4 in condensation.C4 for coverage in condensation.COVERAGES
]


def design() -> list[Row]:
    """Return the map and then the other sizes, each in blocks of a seed."""
    cells = [(noise, BOATS, coverage) for coverage in COVERAGES for noise in NOISES]
    of_map = [cell for cell in cells if cell[::2] not in _MEASURED_BEFORE]
    literal = [(LITERAL, n, coverage) for n in (100, 400) for coverage in DENSE]
    large = [({**WHITE, "c4": c4}, 800, each) for c4 in condensation.C4 for each in DENSE]
    largest = [({**WHITE, "c4": max(condensation.C4)}, 1600, max(DENSE))]
    blocks = [
        (seed, *cell)
        for cells in (of_map, literal, large, largest)
        for seed in range(SEEDS)
        for cell in cells
    ]
    return [
        {**noise, "width_cm": WIDTH_CM, "n_boats": n, "coverage": coverage, "start": start}
        | {"minutes": 60.0 * HOURS, "seed": FIRST + seed}
        for seed, noise, n, coverage in blocks
        for start in STARTED
    ]


def measure(row: Row) -> Row:
    """Follow a flock, and return the means of each hour, with the share of slow boats."""
    return condensation.hours(condensation.follow(row), row["start"] == "rotating")


STUDY = Study(
    "transition/phases",
    design,
    measure,
    lambda row: row["n_boats"] <= BOATS and row["coverage"] == max(DENSE),
)


def whole_blocks(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of blocks that are complete."""
    block = ["n_boats", "seed"]
    asked = pd.DataFrame(design()).groupby(block).size()
    made = table.groupby(block)["c4"].transform("size")
    return table[made.to_numpy() == asked.loc[pd.MultiIndex.from_frame(table[block])].to_numpy()]


def lasts(runs: pd.DataFrame, strict: float = 1.0, apart: bool = False) -> pd.Series:
    """Return which flocks are in the state that they started in, in the last hour.

    `strict` makes the bounds stricter: as many times the boats in jams, and that part of what |m|
    is short of 1. If states are to be `apart`, a flock with jams that rotates is not jammed.
    """
    from_jam, abs_m = runs["start"] == "one-jam", runs[f"abs_m_{HOURS}"]
    jams = runs[f"in_jams_{HOURS}"] >= strict * JAMS
    jams &= (abs_m < ROTATES) | (not apart)
    return jams.where(from_jam, 1.0 - abs_m <= (1.0 - ROTATES) / strict)


def both_last(noise: pd.DataFrame) -> tuple[str, Interval]:
    """Return the neighboring coverages where the rarer state is most frequent, and its share."""
    coverages = sorted(noise["coverage"].unique())
    best = ("no neighboring coverages", unknown())
    for pair in pairwise(coverages):
        own = noise[noise["coverage"].isin(pair)]
        shares = [proportion(lasts(runs).sum(), len(runs)) for _, runs in own.groupby("start")]
        rarer = min(shares)
        if len(shares) == len(STARTED) and not rarer[0] <= best[1][0]:
            best = (f"coverages {pair[0]:g} and {pair[1]:g}", rarer)
    return best


def judge(own: pd.DataFrame, before: pd.DataFrame) -> Claims:
    """Judge the rule by these runs and those of `condensation.py`."""
    claims = Claims("5.2, left open", "", ours=True)
    table = pd.concat([own, before], ignore_index=True)
    weaker: pd.DataFrame | None = None
    for noise in NOISES:
        runs = table[(table["scheme"] == noise["scheme"]) & (table["c4"] == noise["c4"])]
        claims.reading = _reading(noise)
        of_map = runs[(runs["n_boats"] == BOATS) & runs["start"].isin(STARTED)]
        pair, share = both_last(of_map)
        claims.add(
            "One jam and rotation both last for three hours",
            f"flocks that stay in the rarer state, {pair}",
            share,
            least=LASTS,
            n=f"{BOATS}",
        )
        dense = of_map[of_map["coverage"] == max(DENSE)]
        found = outside(dense).dropna().to_frame()
        if weaker is not None and noise is not LITERAL:
            claims.add(
                "More boats stay outside of jams at a stronger noise",
                f"coverage outside of jams, minus that of the next weaker noise, coverage "
                f"{max(DENSE):g}",
                difference(weaker, found),
                least=0.0,
                n=f"{BOATS}",
            )
        weaker = found
        _one_ring(claims, runs)
        condensation.judge_noise(claims, runs)
    known = {(each.claim, each.reading, each.quantity) for each in condensation.judge(before)}
    claims[:] = [each for each in claims if (each.claim, each.reading, each.quantity) not in known]
    return claims


def _reading(noise: Row) -> str:
    name = "literal" if noise is LITERAL else "white"
    return (
        f"{noise['scheme']}, {name} c4 = {noise['c4']:g}, dt = {noise['dt_s']:g} s, bw = 0, "
        f"ring of {WIDTH_CM:g} cm"
    )


def _one_ring(claims: Claims, runs: pd.DataFrame) -> None:
    """Judge whether boats that are added to a ring join its jams."""
    few, many = DENSE
    found = runs.assign(outside=outside(runs)).dropna(subset="outside")
    for n, fewer in found[found["coverage"] == few].groupby("n_boats"):
        twice = np.isclose(found["n_boats"], n * many / few)
        more = found[(found["coverage"] == many) & twice]
        if len(more):
            claims.add(
                "Boats that are added to a ring join its jams",
                f"boats outside of jams per boat added, {n:g} to {n * many / few:g} boats",
                difference(fewer[["outside"]], more[["outside"]], 1.0 / (many - few)),
                least=-ADDED,
                most=ADDED,
            )


_KEY = ["scheme", "c4", "n_boats", "coverage", "start"]


def cells(table: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each cell: how many flocks last, and means of the third hour.

    A start half in a jam is no state that could last. What is outside of jams is the mean over all
    flocks, where statements count those with jams.
    """
    rows = []
    for key, runs in table.groupby(_KEY, sort=False):
        row = dict(zip(_KEY, key, strict=True)) | {"runs": len(runs)}
        for name, how in (("last", (1.0,)), ("last_strict", (2.0,)), ("last_apart", (1.0, True))):
            row[name] = int(lasts(runs, *how).sum()) if row["start"] in STARTED else ""
        in_jams = runs[f"in_jams_{HOURS}"]
        for name, values in (
            ("in_jams", in_jams),
            ("abs_m", runs[f"abs_m_{HOURS}"]),
            ("outside", runs["coverage"] * (1.0 - in_jams)),
            ("not_slow", (runs["coverage"] * (1.0 - runs[f"slow_{HOURS}"])).dropna()),
        ):
            row |= dict(zip((name, f"{name}_low", f"{name}_high"), mean(values), strict=True))
        rows.append(row)
    return pd.DataFrame(rows)


def draw(options: Options, found: pd.DataFrame) -> None:
    """Draw the share in jams from each start over noise and coverage, and what stays outside."""
    with picture(options, "phases", height_cm=13.0) as figure:
        upper, lower = figure.subfigures(2, 1, height_ratios=(1.1, 1.0))
        _draw_map(upper, found[found["n_boats"] == BOATS])
        left, right = lower.subplots(1, 2, sharey=True)
        dense = found[found["coverage"] == max(DENSE)]
        _draw_outside(left, dense[(dense["n_boats"] == BOATS) & (dense["scheme"] != "paper")], "c4")
        left.set(xscale="log", xlabel="c4 (rad/s^1.5), 200 boats")
        left.set_ylabel(f"coverage outside of jams,\ncoverage {max(DENSE):g}")
        strong = dense[(dense["c4"] == max(condensation.C4)) & (dense["scheme"] != "paper")]
        _draw_outside(right, strong, "n_boats")
        right.set(xscale="log", xlabel=f"boats, c4 = {max(condensation.C4):g}")
        for axes, name in ((left, "c4"), (right, "n_boats")):
            values = sorted(found.loc[found["scheme"] != "paper", name].unique())
            axes.set_xticks(values, [f"{each:g}" for each in values])
            axes.minorticks_off()
            axes.axhline(max(DENSE), color="0.7", zorder=0)  # No boat in a jam.
        if len(dense.dropna(subset="outside")):  # A trial is too short for jams.
            left.legend(title="started")


def _draw_map(figure: Any, found: pd.DataFrame) -> None:
    panels = figure.subplots(1, len(STARTED), sharey=True)
    for axes, (start, words) in zip(panels, STARTED.items(), strict=True):
        share = np.full((len(NOISES), len(COVERAGES)), np.nan)
        for row, noise in enumerate(NOISES):
            for column, coverage in enumerate(COVERAGES):
                cell = found[
                    (found["scheme"] == noise["scheme"])
                    & (found["c4"] == noise["c4"])
                    & (found["coverage"] == coverage)
                    & (found["start"] == start)
                ]
                if len(cell):
                    share[row, column] = cell["in_jams"].iloc[0]
                    axes.text(
                        column,
                        row,
                        f"{cell['last'].iloc[0]}/{cell['runs'].iloc[0]}",
                        ha="center",
                        va="center",
                        color="w" if share[row, column] > 0.55 else "k",
                    )
        axes.grid(visible=False)
        drawn = axes.imshow(
            share, cmap=DENSITIES, vmin=0.0, vmax=1.0, origin="lower", aspect="auto"
        )
        axes.set_title(f"start {words}")
        axes.set_xticks(range(len(COVERAGES)), [f"{each:g}" for each in COVERAGES])
        axes.set_xlabel("coverage")
    names = ["literal" if each is LITERAL else f"{each['c4']:g}" for each in NOISES]
    panels[0].set_yticks(range(len(NOISES)), names)
    panels[0].set_ylabel("c4")
    figure.colorbar(drawn, ax=panels, label="share of boats in jams")


def _draw_outside(axes: Any, found: pd.DataFrame, across: str) -> None:
    for place, start in enumerate(STARTED):
        own = found[found["start"] == start].dropna(subset="outside").sort_values(across)
        if len(own):
            names = ["outside", "outside_low", "outside_high"]
            style = {"color": COLORS[place], "marker": "os"[place]}
            intervals = own[names].itertuples(index=False)
            curve(axes, own[across], intervals, label=STARTED[start], **style)


def script(options: Options) -> None:
    """Make the runs, judge and draw them."""
    own = STUDY.results(options)
    own = own if options.trial else whole_blocks(own)
    before = condensation.STUDY.results(Options(options.trial, 1, options.out, runs=False), True)
    if not len(own):
        return
    before = condensation.whole_blocks(before) if len(before) else own.iloc[:0]
    write_claims(options, "phases", judge(own, before))
    found = cells(pd.concat([own, before], ignore_index=True))
    text = found.to_csv(index=False, float_format="%.3g", lineterminator="\n")
    write(options.folder / "phases.csv", text.encode())
    draw(options, found)


if __name__ == "__main__":
    main(script)
