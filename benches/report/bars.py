"""What has to be reached, and whether it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from formats import plain, table, times
from measurements import BOX2D, OURS, RAPIER, TIGHT_RAPIER, Measurements, ours, pick


@dataclass(frozen=True)
class Bar:
    """One line of the table; a bar is reached from below or from above."""

    what: str
    wanted: float
    reached: float
    at_least: bool = True
    unit: str = "×"
    note: str = ""

    @property
    def holds(self) -> bool:
        """Whether it is reached."""
        return self.reached >= self.wanted if self.at_least else self.reached <= self.wanted

    def row(self) -> list[str]:
        """Its cells."""
        sign = "≥" if self.at_least else "≤"
        verdict = "reached"
        if not self.holds:
            short = self.wanted / self.reached if self.at_least else self.reached / self.wanted
            verdict = f"**falls short by a factor of {plain(short)}**"
        name = f"{self.what} ({self.note})" if self.note else self.what
        wanted = f"{sign} {self.wanted:g} {self.unit}".strip()
        return [name, wanted, f"{plain(self.reached)} {self.unit}".strip(), verdict]


def bars(m: Measurements) -> list[Bar]:
    """All bars, the hard ones first."""
    settings = m.settings()
    mine, theirs = pick(settings, OURS), pick(settings, RAPIER)
    tight = pick(settings, TIGHT_RAPIER)
    large = pick(m.speed, OURS, scene="jam", n=1000)
    growth = m.growth.set_index("n")
    most = int(growth.index.max())
    own = m.overlap[(m.overlap.engine == "flockenv") & (m.overlap.solver == "block-pivoting")]
    found = [
        Bar("27 boats, jam: faster than rapier2d-f64", 5, mine.jam_faster),
        Bar("27 boats, cycle: faster than rapier2d-f64", 8, mine.cycle_faster),
        Bar("1000 boats, jam: faster than rapier2d-f64", 2, large.faster),
        Bar(
            "27 boats, jam: less overlap (mean of each step's deepest)",
            40,
            theirs.jam_overlap_mean_cm / mine.jam_overlap_mean_cm,
        ),
        Bar(
            "the same against rapier2d-f64 with its tolerances at unit 1 cm",
            40,
            tight.jam_overlap_mean_cm / mine.jam_overlap_mean_cm,
            note="not asked for",
        ),
        Bar("less slide error after 2 s", 100, theirs.slide_median_cm / mine.slide_median_cm),
        Bar(
            "natural residual, worst of all scenes, sizes, schemes and steps",
            1e-10,
            own.residual_cm_s.max(),
            at_least=False,
            unit="cm/s",
        ),
        Bar("solves without an exact solution", 0, own.unsolved.sum(), at_least=False, unit=""),
        Bar(f"{most} boats at dt = 0.02 s: times real time", 1, growth.times_real_time[most]),
        Bar(
            "memory in use besides the factor, as a power of n",
            1.05,
            _power(growth.bytes_in_use_per_boat - 8 * growth.factor_entries_per_boat),
            at_least=False,
            unit="",
        ),
        Bar(
            "memory held, room for growth included, as a power of n",
            1.05,
            _power(growth.bytes_per_boat),
            at_least=False,
            unit="",
            note="not asked for",
        ),
    ]
    for relinearizations, bound in enumerate([1e-2, 1e-6, 1e-9]):
        row = pick(settings, ours("leapfrog", relinearizations))
        deepest = max(row.jam_overlap_max_cm, row.cycle_overlap_max_cm)
        what = f"deepest overlap, jam and cycle, relinearizations = {relinearizations}"
        found.append(Bar(what, bound, deepest, at_least=False, unit="cm"))
    return found + _goals(m, mine, large)


def _power(per_boat: pd.Series) -> float:
    """Exponent of the whole in n, over flocks of 100 boats and more if there are any."""
    is_full = per_boat.index.max() > 1000
    chosen = per_boat[per_boat.index >= 100] if is_full else per_boat
    return 1 + np.polyfit(np.log(chosen.index), np.log(chosen), 1)[0]


def _goals(m: Measurements, mine: pd.Series, large: pd.Series) -> list[Bar]:
    goals = [
        Bar("27 boats, jam", 5, mine.jam_us_per_step, False, "µs a step", "goal"),
        Bar("27 boats, cycle", 2, mine.cycle_us_per_step, False, "µs a step", "goal"),
        Bar("1000 boats, jam", 250, large.us_per_step, False, "µs a step", "goal"),
    ]
    for boats in sorted(m.speed[m.speed.scene == "jam"].n.unique()):
        own = pick(m.speed, OURS, scene="jam", n=boats)
        other = pick(m.speed, BOX2D, scene="jam", n=boats)
        ratio = other.us_per_step / own.us_per_step
        goals.append(Bar(f"{boats} boats, jam: faster than Box2D", 1, ratio, note="goal"))
    return goals


def bars_table(m: Measurements) -> str:
    """The table."""
    return table(["at dt = 0.01 s", "wanted", "measured", ""], (bar.row() for bar in bars(m)))


def headline(m: Measurements) -> str:
    """One sentence for those in a hurry."""
    settings = m.settings()
    mine, theirs = pick(settings, OURS), pick(settings, RAPIER)
    overlap = theirs.jam_overlap_mean_cm / mine.jam_overlap_mean_cm
    slide = theirs.slide_median_cm / mine.slide_median_cm
    return (
        f"27 boats at dt = 0.01 s take {plain(mine.jam_us_per_step)} µs a step jammed against the "
        f"wall and {plain(mine.cycle_us_per_step)} µs in the fw-nop-bw-nop cycle: "
        f"{times(mine.jam_faster)} and {times(mine.cycle_faster)} as fast as rapier2d-f64, with "
        f"{times(overlap)} less overlap and {times(slide)} less error in sliding."
    )
