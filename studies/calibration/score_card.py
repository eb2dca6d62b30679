"""The score card: what Sections 4 and 6 say of 27 boats, as numbers with ranges.

A number is a function of means over seeds, so that its interval comes from drawing seeds: the runs
of one seed share their random streams, and it counts once. The ranges, and what was read into words
such as "occasionally", were written before any run of this study.
"""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from flockenv.statistics import bootstrap_interval
from studies.claim import DISORDER, FAILS, HOLDS, OPEN, Interval, crossing
from studies.order import MOSTLY, PHI_EDGES
from studies.section4 import fig07, section4, states
from studies.study import Row, simulated

ARMS: dict[str, tuple[int, str]] = {"free": (0, "cw"), "ccw": (3, "ccw"), "cw": (3, "cw")}
LED = ("ccw", "cw")
CENTERS = (PHI_EDGES[1:] + PHI_EDGES[:-1]) / 2
_TANGENT = abs(CENTERS - np.pi / 2) < np.pi / 18
COUNTS_AT_S, FOLLOWING_AT_S, LONGEST_AT_S = 1.8, 1.8, (1.4, 1.9)
WORST = 9.0
"""Most that one number adds to the misfit: three tolerances, squared."""


# --- what is measured of one seed -----------------------------------------------------------------


def features(row: Row, levels_s: Sequence[float], counts: Sequence[int]) -> Row:
    """Return what the score card needs of a seed: runs at all noises in all arms, and three more.

    `counts` are numbers of counter-clockwise leaders of figure 12 beside none and three.
    """
    found: Row = {}
    for arm, (leaders, target) in ARMS.items():
        changes = {"n_leaders": leaders, "target": target}
        runs = {bw_s: section4.measure(row | changes | {"bw_s": bw_s}) for bw_s in levels_s}
        found |= features_of(arm, runs)
    both = [np.array([found.pop(f"{arm} {place}") for place in range(36)]) for arm in LED]
    found |= {f"led {place}": each for place, each in enumerate(np.mean(both, axis=0))}
    for k in counts:
        run = row | {"n_leaders": k, "target": "ccw", "bw_s": COUNTS_AT_S}
        found[f"k {k}"] = section4.measure(run)["psi_o"]
    found["k 0"], found["k 3"] = (found[f"{arm} psi_o {COUNTS_AT_S:g}"] for arm in ("free", "ccw"))
    long = row | {"minutes": 2 * row["minutes"]}
    for bw_s in LONGEST_AT_S:
        run = simulated(long | {"n_leaders": 0, "bw_s": bw_s}, sample_hz=5.0)
        found[f"longest {bw_s:g}"] = np.nan_to_num(states.longest_min(states.cycles(run)))
    turns = fig07.measure(long | {"n_leaders": 3, "bw_s": FOLLOWING_AT_S})
    towards = np.array([turns[f"stretch_{place}"] for place in range(4)])
    return found | {"follows": (towards > 0.0).mean(), "towards": towards.mean()}


def features_of(arm: str, runs: dict[float, Row]) -> Row:
    """Return the features of an arm; its histogram is turned so that its leaders go clockwise."""
    turned = {bw_s: histogram(run)[:: -1 if arm == "ccw" else 1] for bw_s, run in runs.items()}
    found: Row = {}
    for bw_s, run in runs.items():
        mirrored = (turned[bw_s] + turned[bw_s][::-1]) / 2 if arm == "free" else turned[bw_s]
        found[f"{arm} psi_o {bw_s:g}"] = run["psi_o"]
        found[f"{arm} tangent {bw_s:g}"] = len(CENTERS) * mirrored[_TANGENT].mean()
        if bw_s <= 0.8:
            found[f"{arm} jammed {bw_s:g}"] = run["jammed"]
        if arm == "free":
            found[f"{arm} c_v {bw_s:g}"] = run["c_v"]
    low = [run for bw_s, run in runs.items() if bw_s <= 0.8]
    rotates = np.array([run["cw"] + run["ccw"] >= MOSTLY for run in low])
    late = np.array([run["psi_o_late"] for run in low])
    found |= {f"{arm} rotates": rotates.mean(), f"{arm} late": (rotates * late).mean()}
    came = [math.isfinite(r["ordered_quarter_s"]) for bw_s, r in runs.items() if bw_s >= 1.4]
    found[f"{arm} comes"] = np.mean(came)
    if arm == "free":
        medium = [run for bw_s, run in runs.items() if 0.8 <= bw_s <= 1.4]
        below = [run["cw"] + run["ccw"] for bw_s, run in runs.items() if bw_s <= 1.6]
        found |= {f"free {way}": np.mean([run[way] for run in medium]) for way in LED}
        return found | {"free motion": np.mean(below)}
    found |= {f"{arm} own": np.mean([run[arm] for run in runs.values()])}
    found |= {f"{arm} either": np.mean([run["cw"] + run["ccw"] for run in runs.values()])}
    high = np.mean([each for bw_s, each in turned.items() if bw_s > 2.1], axis=0)
    return found | {f"{arm} {place}": each for place, each in enumerate(high)}


def histogram(run: Row) -> Any:
    """Return the shares of frames in the bins of φ_o."""
    return np.array(run["phi_histogram"].split(), float) / 1000.0


# --- means over seeds -----------------------------------------------------------------------------


Curve = tuple[list[float], Any]
"""Noises, and values of shape (noises, draws)."""


class Means:
    """Means of features over seeds, one for each draw."""

    def __init__(self, names: Iterable[str], values: Any) -> None:
        self._values = dict(zip(names, np.moveaxis(np.asarray(values, float), -1, 0), strict=True))

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def curve(self, arm: str, quantity: str) -> Curve:
        """Return the noises of an arm and a quantity at them, of shape (noises, draws)."""
        start = f"{arm} {quantity} "
        levels = sorted(
            float(name[len(start) :]) for name in self._values if name.startswith(start)
        )
        return levels, np.stack([self[f"{start}{bw_s:g}"] for bw_s in levels])

    def band(self, arm: str, quantity: str, least: float, most: float) -> Any:
        """Return the mean of a quantity over the noises of a range."""
        levels, values = self.curve(arm, quantity)
        return values[[least - 1e-9 < bw_s < most + 1e-9 for bw_s in levels]].mean(0)

    def led_band(self, quantity: str, least: float, most: float) -> Any:
        """Return that mean over both directions of the leaders."""
        return sum(self.band(arm, quantity, least, most) for arm in LED) / 2

    def led(self, quantity: str) -> Curve:
        """Return a curve as the mean of both directions of the leaders."""
        levels, _ = self.curve("cw", quantity)
        return levels, sum(self.curve(arm, quantity)[1] for arm in LED) / 2


def lost(curve: Curve, level: float) -> Any:
    """Return the noise from which on a curve is below a level; the first if it always is."""
    levels, values = curve
    found = crossing(levels, values.reshape(len(levels), -1), level)
    return np.nan_to_num(found, nan=levels[0]).reshape(values.shape[1:])


def direction_lost(curve: Curve) -> Any:
    """Return where the density at the tangent is lost: mean of 2 and 3 times the uniform one."""
    return (lost(curve, 2.0) + lost(curve, 3.0)) / 2


def _slope(means: Means) -> Any:
    known = [k for k in range(5) if f"k {k}" in means]
    away = np.array(known) - np.mean(known)
    return np.tensordot(away, np.stack([means[f"k {k}"] for k in known]), 1) / (away**2).sum()


def _largest_density(means: Means) -> Any:
    density = len(CENTERS) * np.stack([means[f"led {place}"] for place in range(36)])
    return density.max(0)


def _c_v(means: Means, least: float, most: float) -> Any:
    return means.band("free", "c_v", least, most) / means.curve("free", "c_v")[1].max(0)


def _rarer(means: Means) -> Any:
    ways = [means[f"free {way}"] for way in LED]
    return np.minimum(*ways) / np.sum(ways, axis=0)


def _of_both(means: Means, of: str, over: str) -> Any:
    return sum(means[f"{arm} {of}"] for arm in LED) / sum(means[f"{arm} {over}"] for arm in LED)


# --- the card -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Number:
    """A number of the card.

    Attributes
    ----------
    name, section
        In a few words, and where the paper says it.
    quantity
        What is measured.
    value
        Of means over seeds.
    least, most
        The range that the paper's words claim, as we read them.
    tolerance
        Distance from it that counts as one.
    missed
        Whether it is one of the ten misses of `experiment` that a new preset has to mend.
    """

    name: str
    section: str
    quantity: str
    value: Callable[[Means], Any]
    least: float
    most: float
    tolerance: float
    missed: bool = False

    def of(self, means: Means) -> Any:
        """Return the number; NaN where nothing rotates."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.value(means)

    def away(self, value: Any, margin: float = 0.0) -> Any:
        """Return how far outside of the range a value is, in tolerances, below 0 if it is small.

        The range is narrower by the margin at both ends, in tolerances.
        """
        inset = margin * self.tolerance
        above, below = value - self.most + inset, value - self.least - inset
        return (np.maximum(above, 0.0) + np.minimum(below, 0.0)) / self.tolerance

    def verdict(self, found: Sequence[float]) -> str:
        """Return whether the whole interval lies in the range, outside it, or neither."""
        _, low, high = found
        if low >= self.least and high <= self.most:
            return HOLDS
        return FAILS if high < self.least or low > self.most else OPEN


CARD = (
    Number(
        "jams at 0 s", "6", "share of jammed frames, bw = 0, no leaders",
        lambda m: m["free jammed 0"], 0.5, math.inf, 0.1,
    ),
    Number(
        "jams at 0.4 s", "4.3", "share of jammed frames, bw = 0.4 s, no leaders",
        lambda m: m["free jammed 0.4"], 0.02, 0.3, 0.1, missed=True,
    ),
    Number(
        "jams mainly without leaders", "4.3",
        "share of jammed frames, bw 0 to 0.8 s, without leaders minus with 3",
        lambda m: m.band("free", "jammed", 0, 0.8) - m.led_band("jammed", 0, 0.8),
        0.0, math.inf, 0.05,
    ),
    Number(
        "direction lost, no leaders", "4.3",
        "bw (s) at which the density of φ_o at the tangent is lost, no leaders",
        lambda m: direction_lost(m.curve("free", "tangent")), 1.2, 1.6, 0.1, missed=True,
    ),
    Number(
        "direction lost, 3 leaders", "4.3",
        "bw (s) at which the density of φ_o at the tangent is lost, 3 leaders",
        lambda m: direction_lost(m.led("tangent")), 1.8, 2.2, 0.1,
    ),
    Number(
        "Ψ_o lost, no leaders", "4.2, 4.4",
        "bw (s) at which mean Ψ_o falls through 0.3, no leaders",
        lambda m: lost(m.curve("free", "psi_o"), DISORDER), 1.65, 2.05, 0.1,
    ),
    Number(
        "Ψ_o lost, 3 leaders", "4.3", "bw (s) at which mean Ψ_o falls through 0.3, 3 leaders",
        lambda m: lost(m.led("psi_o"), DISORDER), 1.85, 2.25, 0.1,
    ),
    Number(
        "longest order at 1.4 s", "4.2", "longest order one way in 16 min (min), bw = 1.4 s",
        lambda m: m["longest 1.4"], 5.0, math.inf, 1.0, missed=True,
    ),
    Number(
        "longest order at 1.9 s", "4.2", "longest order one way in 16 min (min), bw = 1.9 s",
        lambda m: m["longest 1.9"], 0.2, 5.0, 0.2, missed=True,
    ),
    Number(
        "flock follows", "4.2", "share of stretches that go the leaders' way, bw = 1.8 s",
        lambda m: m["follows"], 0.9, math.inf, 0.05,
    ),
    Number(
        "m towards leaders", "4.2", "mean m towards alternating leaders, bw = 1.8 s",
        lambda m: m["towards"], 0.4, math.inf, 0.1,
    ),
    Number(
        "slope of figure 12", "4.4", "slope of mean Ψ_o against 0 to 4 CCW leaders, bw = 1.8 s",
        _slope, 0.03, math.inf, 0.02,
    ),
    Number(
        "C_v at very low noise", "4.3", "mean C_v at bw 0 to 0.4 s over its maximum, no leaders",
        lambda m: _c_v(m, 0.0, 0.4), -math.inf, 0.5, 0.1,
    ),
    Number(
        "C_v at high noise", "4.3", "mean C_v at bw ≥ 2.4 s over its maximum, no leaders",
        lambda m: _c_v(m, 2.4, 9.0), -math.inf, 0.1, 0.05,
    ),
    Number(
        "Ψ_o in order, no leaders", "4.3",
        "mean Ψ_o of second halves of runs that mostly rotate, bw 0 to 0.8 s, no leaders",
        lambda m: m["free late"] / m["free rotates"], 0.9, math.inf, 0.05,
    ),
    Number(
        "Ψ_o in order, 3 leaders", "4.3",
        "mean Ψ_o of second halves of runs that mostly rotate, bw 0 to 0.8 s, 3 leaders",
        lambda m: _of_both(m, "late", "rotates"), 0.9, math.inf, 0.05, missed=True,
    ),
    Number(
        "Ψ_o in disorder", "4.3", "mean Ψ_o, bw ≥ 2.4 s, no leaders",
        lambda m: m.band("free", "psi_o", 2.4, 9.0), -math.inf, 0.3, 0.05,
    ),
    Number(
        "leaders add coherence", "4.3, 4.5",
        "mean Ψ_o with 3 CCW leaders minus without, bw 1.4 to 2.0 s",
        lambda m: m.band("ccw", "psi_o", 1.4, 2.0) - m.band("free", "psi_o", 1.4, 2.0),
        0.2, math.inf, 0.05, missed=True,
    ),
    Number(
        "leaders against the bias", "4.5",
        "mean Ψ_o with 3 CCW leaders minus with 3 CW ones, bw 1.4 to 2.0 s",
        lambda m: m.band("ccw", "psi_o", 1.4, 2.0) - m.band("cw", "psi_o", 1.4, 2.0),
        0.1, math.inf, 0.05, missed=True,
    ),
    Number(
        "order is regular", "4.1", "share of frames in rotation, bw 0 to 1.6 s, no leaders",
        lambda m: m["free motion"], 0.5, math.inf, 0.1, missed=True,
    ),
    Number(
        "both directions", "4.3",
        "share of the rarer direction in rotating frames, bw 0.8 to 1.4 s, no leaders",
        _rarer, 0.2, math.inf, 0.1,
    ),
    Number(
        "leaders' direction alone", "4.3", "share of rotating frames that go the leaders' way",
        lambda m: _of_both(m, "own", "either"), 0.95, math.inf, 0.02,
    ),
    Number(
        "uniform above 2 s", "4.3", "largest over mean density of φ_o, bw > 2 s, 3 leaders",
        _largest_density, -math.inf, 1.5, 0.2, missed=True,
    ),
    Number(
        "leaders extend the range", "4.2",
        "share of runs that order (eq. (7), π/4) at bw ≥ 1.4 s, with 3 leaders minus without",
        lambda m: sum(m[f"{arm} comes"] for arm in LED) / 2 - m["free comes"],
        0.0, math.inf, 0.05, missed=True,
    ),
)  # fmt: skip


def misfit(values: Iterable[Any], margin: float = 0.0) -> Any:
    """Return the sum of squared distances from the ranges of the card, each at most `WORST`.

    Ranges are narrower by the margin at both ends, in tolerances.
    """
    away = (number.away(value, margin) for number, value in zip(CARD, values, strict=True))
    return sum(np.nan_to_num(np.minimum(each**2, WORST), nan=WORST) for each in away)


def values_of(means: Means) -> list[Any]:
    """Return the numbers of the card."""
    return [number.of(means) for number in CARD]


def over_seeds(tables: Sequence[pd.DataFrame], statistic: Callable[..., Any]) -> Interval:
    """Return a statistic of means over seeds with its interval; tables have the same seeds."""
    names, arrays = list(tables[0]), [table.to_numpy(float) for table in tables]
    seeds = len(arrays[0])

    def of_places(places: Any, axis: int) -> Any:
        chosen = np.asarray(places, int)
        shares = (chosen[..., None] == np.arange(seeds)).mean(-2)
        return statistic(*(Means(names, shares @ array) for array in arrays))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Draws without spread.
        found = bootstrap_interval([np.arange(seeds)], of_places)
    return Interval(found, seeds)
