"""Do README's headlines hold from other starts, with other leaders, steps and shares of start-up?

Each headline is measured again as README has it and with one thing changed: flocks that start in
one jam or rotating (against their leaders, if they have any) instead of at random and at rest;
leaders that do not back up with the others, or do; another step; and the second half of each run
alone. The ranges below were written before the runs, but for those of what leaders add: there the
middle between order and disorder was asked before, which is ill-defined with the fitted constants.
"""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from studies.claim import Claims, Interval, bca, disorder, fall, judging, mean, unknown
from studies.density.noise_makes_motion import SETS, order_row
from studies.flocks import one_jam, rotating
from studies.picture import COLORS, curve, picture
from studies.study import SEEDS, Options, Row, Study, flock, main, seed_of

FIRST = 200
"""Seeds that no other study of this folder has."""
EPISODES = 96
VARIANTS = ("as it is", "one jam", "rotating", "leaders reversed", "other step")
"""What is changed in the runs; "second half" is measured in the runs of the first."""
STARTS = {"one jam": one_jam, "rotating": rotating}
LAW, LED = "paper's law", ("learned", "tuned law", "paper's law")
_SHIFT_S = (0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.4, 2.8)
_LOST_S = {
    "simulation": (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1.0),
    "paper": (0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2),
}


@dataclass(frozen=True)
class Cells:
    """Runs of one set of constants, boats and leaders: noises, policies and seeds."""

    name: str
    pool: str
    n_boats: int
    noises: tuple[float, ...]
    leaders: tuple[int, ...] = (0,)
    policies: tuple[str, ...] = (LAW,)
    seeds: int = SEEDS
    minutes: float = 8.0

    def rows(self, variant: str) -> list[Row]:
        """Return the runs of a variant; none where it changes nothing."""
        given = SETS[self.name]
        known = flock(given).to_dict()
        per_step = known["scheme"] == "paper"
        reverse = known["leaders_reverse"] != (variant == "leaders reversed")
        dt_s = (0.05 if per_step else 0.1) if variant == "other step" else known["dt_s"]
        return [
            {"variant": variant, "set": self.name, "pool": self.pool, "n_boats": self.n_boats}
            | {"n_leaders": k, "policy": policy, "bw_s": bw_s, "dt_s": dt_s}
            | {"leaders_reverse": reverse, "minutes": self.minutes, "seed": FIRST + seed}
            for seed, bw_s, k, policy in itertools.product(
                range(self.seeds), self.noises, self.leaders, self.policies
            )
            if variant != "leaders reversed" or max(self.leaders)
        ]


WIDE = Cells("simulation", "wide", 27, (0.31,), (3,), LED, EPISODES)
NARROW_FLOCK = Cells("experiment", "narrow", 27, (0.0, 1.0))
DENSE = Cells("paper", "wide", 50, (0.0, 0.5), minutes=16.0)
SPARSE = Cells("paper", "wide", 20, (0.0, 0.4), minutes=16.0)
SHIFT = Cells("experiment", "narrow", 27, _SHIFT_S, (0, 3))
SHIFT_FITTED = Cells("fitted", "narrow", 27, _SHIFT_S, (0, 3))
LOST = Cells("simulation", "wide", 20, _LOST_S["simulation"], minutes=16.0)
LOST_PAPER = Cells("paper", "wide", 20, _LOST_S["paper"], minutes=16.0)
ALL = (WIDE, NARROW_FLOCK, DENSE, SPARSE, SHIFT, SHIFT_FITTED, LOST, LOST_PAPER)


def design() -> list[Row]:
    """Return the runs, each headline in all variants before the next."""
    rows = [row for cells in ALL for variant in VARIANTS for row in cells.rows(variant)]
    return list({tuple(row.values()): row for row in rows}.values())


def measure(row: Row) -> Row:
    """Return the order after the first tenth of a run, and in its second half."""
    led = row["n_leaders"] > 0
    against = led and row["variant"] == "rotating"
    parameters = flock(SETS[row["set"]] | row, target="ccw" if against else "cw")
    named = led and row["set"] == "simulation"
    start = STARTS.get(row["variant"])
    seed = seed_of(row)
    run = flockenv.simulate(
        parameters,
        seed,
        60.0 * row["minutes"],
        4.0,
        dtype=np.float32,
        policy=row["policy"] if named else None,
        start=None if start is None else start(parameters, seed).snapshot(),
    )
    found = {}
    for suffix, after in (("", 0.1), ("_late", 0.5)):
        measured = order_row(run, after)
        found |= {name + suffix: measured[name] for name in ("psi_o", "abs_m")}
        signed = run.analyzed(after).order.series("signed_order", parameters.target)
        found[f"signed{suffix}"] = signed.mean()
    return found


STUDY = Study("headlines/headlines", design, measure, lambda row: row["bw_s"] in (0.0, 0.31, 1.0))


class Runs:
    """The runs of a variant: of the second half alone in the variant of that name."""

    def __init__(self, table: pd.DataFrame, variant: str) -> None:
        self.late = "_late" if variant == "second half" else ""
        self.table = table[table["variant"] == ("as it is" if self.late else variant)]

    def of(self, cells: Cells, **values: Any) -> pd.DataFrame:
        """Return the runs of cells."""
        r = self.table
        same = (r["set"] == cells.name) & (r["pool"] == cells.pool)
        found = r[same & (r["n_boats"] == cells.n_boats) & r["bw_s"].isin(cells.noises)]
        for name, value in values.items():
            found = found[found[name] == value]
        return found

    def rise(self, cells: Cells) -> Interval:
        """Return how much mean |m| rises between two noises."""
        runs = self.of(cells, n_leaders=0)
        runs = runs[runs["minutes"] == cells.minutes]
        m = runs.pivot_table(index="seed", columns="bw_s", values=f"abs_m{self.late}").dropna()
        if list(m) != list(cells.noises):
            return unknown()
        return mean(m[cells.noises[1]] - m[cells.noises[0]])

    def groups(self, cells: Cells, leaders: int) -> list[Any]:
        """Return Ψ_o and |m| of the runs at each noise."""
        runs = self.of(cells, n_leaders=leaders)
        columns = [f"psi_o{self.late}", f"abs_m{self.late}"]
        found = [each[columns].to_numpy(float) for _, each in runs.groupby("bw_s")]
        return found if len(found) == len(cells.noises) else [np.empty((0, 2))]

    def shift(self, cells: Cells) -> Interval:
        """Return how much three leaders move the bw at which Ψ_o falls through 0.3 (s)."""
        led, free = self.groups(cells, 3), self.groups(cells, 0)
        return disorder(cells.noises, [led, free], (1.0, -1.0))

    def later(self) -> Interval:
        """Return how much later order is lost in the paper's scheme than in `simulation` (s)."""
        both = [self.groups(cells, 0) for cells in (LOST_PAPER, LOST)]
        half = len(both[0])
        return bca(
            [*both[0], *both[1]],
            lambda *d: fall(LOST_PAPER.noises, d[:half]) - fall(LOST.noises, d[half:]),
        )

    def pair(self, cells: Cells, ours: str, theirs: str) -> Interval:
        """Return the difference of the signed order with two policies, paired by seed."""
        runs = self.of(cells, n_leaders=3)
        found = runs.pivot_table(index="seed", columns="policy", values=f"signed{self.late}")
        if not {ours, theirs} <= set(found):
            return unknown()
        return mean((found[ours] - found[theirs]).dropna())


QUANTITIES = {
    "rise": "mean |m| at the second noise minus that at bw = 0",
    "shift": "bw at which mean Ψ_o falls through 0.3, with 3 leaders minus without (s)",
    "later": "critical bw (s), 20 boats in wide, paper minus simulation",
    "pair": "signed order, first policy minus second, 3 leaders of 27",
}
"""What the methods of `Runs` measure."""

HEADLINES: dict[str, tuple[str, tuple[Any, ...], float, float]] = {
    "27 boats in narrow need backing to move": ("rise", (NARROW_FLOCK,), 0.3, np.inf),
    "50 boats in wide need backing to move": ("rise", (DENSE,), 0.3, np.inf),
    "20 boats in wide need none": ("rise", (SPARSE,), -np.inf, 0.3),
    "Order is lost later in the paper's scheme": ("later", (), 0.1, np.inf),
    "Three leaders hold Ψ_o to more noise": ("shift", (SHIFT,), 0.0, np.inf),
    "They do so with the fitted constants": ("shift", (SHIFT_FITTED,), 0.0, np.inf),
    "Learned leaders beat the tuned law in wide": ("pair", (WIDE, *LED[:2]), 0.0, np.inf),
    "The tuned law beats the paper's in wide": ("pair", (WIDE, *LED[1:]), 0.0, np.inf),
}
"""What README says: how it is measured and the range that it claims."""
CHANGES = (VARIANTS[0], "second half", *VARIANTS[1:])


def judge(table: pd.DataFrame) -> Claims:
    """Judge each headline in each variant that has been run."""
    claims = Claims("README", "", ours=True)
    for words, (kind, given, least, most) in HEADLINES.items():
        for variant in CHANGES:
            found = getattr(Runs(table, variant), kind)(*given)
            claims.reading = variant
            if np.isfinite(found[0]):
                claims.add(words, QUANTITIES[kind], found, least=least, most=most)
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw each headline's value in each variant with its interval and the claimed range."""
    claims = judge(table)
    shown = [words for words in HEADLINES if any(each.claim == words for each in claims)]
    with picture(options, "headlines", height_cm=13.0) as figure:
        panels = figure.subplots(-(-max(len(shown), 1) // 2), 2, squeeze=False, sharex=True)
        for axes, words in zip(panels.flat, shown, strict=False):
            *_, lowest, highest = HEADLINES[words]
            for claim in (each for each in claims if each.claim == words):
                place = CHANGES.index(claim.reading)
                curve(axes, [place], [claim.found], color=COLORS[place], linestyle="")
            low, high = axes.get_ylim()
            low, high = min(low, -0.02), max(high, 0.02)
            axes.axhspan(max(lowest, low), min(highest, high), color="0.93", zorder=0)
            axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            axes.set_ylim(low, high)
            axes.set(xlim=(-0.6, len(CHANGES) - 0.4), xticks=[])
            axes.set_title(words)
        for axes in panels.flat[len(shown) :]:
            axes.set(frame_on=False, yticks=[])
        for axes in panels[-1]:
            axes.set_xticks(range(len(CHANGES)), CHANGES, rotation=40, ha="right")


script = judging("headlines", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
