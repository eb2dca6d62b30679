"""Beyond the paper: whether the jamming–order transition is of first order.

The order parameter is m = Ψ_o sin φ_o, 0 in a jam and ±1 in rotation. Two signs of a transition of
first order are looked for as flocks grow: states that coexist at one density, which make Binder's
cumulant 1 - <m⁴>/(3<m²>²) negative, and hysteresis: |m| larger as the density rises, out of
rotation, than as it falls, out of a jam. At a continuous transition the cumulant stays between 0
and 2/3, and loops close.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import stats

from flockenv.analysis import CONFIDENCE
from flockenv.block_bootstrap import block_sums, block_sums_resampled, interval
from flockenv.loops import loop_position
from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, Claim
from flockenv.reproduce.order_statistics import block_length_s
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.reproduce.transition_design import FULL, WAYS, Growth, TransitionDesign, within
from flockenv.runs import DISCARDED_SHARE, RunResult

__all__ = ["REPRODUCTIONS", "binder", "conclusion", "hysteresis", "transition_order"]

M_EDGES = np.linspace(-1.0, 1.0, 42)
"""Edges of the bins of m."""

_C_V_EDGES = np.linspace(-50.0, 225.0, 45)
_LOOP_BINS = 15
CENTRES = (np.arange(_LOOP_BINS) + 0.5) / _LOOP_BINS
"""Positions in a loop at which its branches are averaged."""

COEXISTENCE = Claim(
    text="Jam and rotation coexist at one density",
    section="5.2, left open",
    quantity="lowest Binder cumulant of m over densities",
    high=0.0,
)
HYSTERESIS = Claim(
    text="Loops in density stay open",
    section="5.2, left open",
    quantity="mean of |m| as density rises minus |m| as it falls, over a loop",
    low=0.1,
)


def binder(m2: NDArray[np.float64], m4: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Binder's cumulant 1 - <m⁴>/(3<m²>²); NaN where <m²> is 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(1.0 - m4 / (3.0 * m2**2))


class _Moments:
    """Moments of m and C_v over runs at one density, as measured and resampled; and densities."""

    def __init__(self, runs: Sequence[RunResult]) -> None:
        blocks = []
        for run in runs:
            used = run.analysed
            m, c_v = run.order.rotation()[used], run.order.c_v[used]
            powers = [np.ones(len(m)), m**2, m**4, c_v**2, c_v**4, abs(m), c_v]
            length = block_length_s(run.spec.duration_s)
            blocks.append(block_sums(run.time_s[used], np.stack(powers, axis=1), length))
        sums = block_sums_resampled(blocks, int(runs[0].spec.key[:8], 16))
        means = (sums[:, 1:] / sums[:, :1]).T
        self.binder_m, self.binder_c_v = binder(means[0], means[1]), binder(means[2], means[3])
        self.m, self.c_v = means[4], means[5]
        every = [(run.order.rotation()[run.analysed], run.order.c_v[run.analysed]) for run in runs]
        ms, c_vs = (np.concatenate(each) for each in zip(*every, strict=True))
        self.m_density = np.histogram(ms, M_EDGES, density=True)[0]
        self.c_v_density = np.histogram(c_vs, _C_V_EDGES)[0] / len(c_vs) / np.diff(_C_V_EDGES)


def hysteresis(run: RunResult) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean |m| on the way there and on the way back, by position in the loop.

    Returns
    -------
    tuple of float64 arrays, shape (15,)
        Of analysed frames, from the loop's first scene to its last; NaN in bins without any.
    """
    m = abs(run.order.rotation())
    position = loop_position(run.time_s, run.spec.duration_s)
    place = np.minimum((position * _LOOP_BINS).astype(int), _LOOP_BINS - 1)
    there = run.time_s < run.spec.duration_s / 2
    ways = []
    for way in (there, ~there):
        used = run.in_analysis_window & way
        count = np.bincount(place[used], minlength=_LOOP_BINS)
        total = np.bincount(place[used], m[used], minlength=_LOOP_BINS)
        with np.errstate(invalid="ignore"):
            ways.append(total / count)
    return ways[0], ways[1]


class _Loops:
    """Loops of some seeds: mean branches, and by how much |m| there exceeds |m| back.

    The part of the loop that the first tenth of the run goes through does not count.
    """

    def __init__(self, runs: Sequence[RunResult]) -> None:
        branches = np.array([hysteresis(run) for run in runs])
        self.there, self.back = _known_mean(branches, 0)
        settled = CENTRES > 2 * DISCARDED_SHARE
        openings = (branches[:, 0] - branches[:, 1])[:, settled]
        self.opening = _student(_known_mean(openings, 1))


def _known_mean(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Mean without the undefined values; NaN where all are."""
    known = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, values, 0.0).sum(axis) / known.sum(axis))


def _student(values: NDArray[np.float64]) -> tuple[float, float, float]:
    """Mean of a few independent values with Student's interval."""
    mean, count = float(values.mean()), len(values)
    if count < 2:
        return mean, float("nan"), float("nan")
    quantile = float(stats.t.ppf((1 + CONFIDENCE) / 2, count - 1))
    half = quantile * float(values.std(ddof=1)) / count**0.5
    return mean, mean - half, mean + half


def conclusion(claims: Sequence[CheckedClaim]) -> str:
    """Return what the claims for the larger sizes say: a rule settled before the runs.

    Parameters
    ----------
    claims
        `COEXISTENCE` and `HYSTERESIS` for the larger half of the sizes.
    """
    verdicts = {claim.verdict for claim in claims}
    if verdicts == {HOLDS}:
        return "first order: states coexist and loops stay open at all of the larger sizes"
    if verdicts == {DOES_NOT_HOLD}:
        return "not first order: states do not coexist and loops close at all of the larger sizes"
    open_for = "; ".join(
        f"{claim.claim.text.lower()} {claim.verdict} for {claim.scope}"
        for claim in claims
        if claim.verdict != HOLDS
    )
    return (
        f"inconclusive: {open_for}. More seeds narrow the intervals, slower loops tell hysteresis "
        "from lag, and larger flocks tell a lasting cumulant from one that fades"
    )


def _analyse(design: TransitionDesign, settings: Settings, results: Results) -> Outcome:
    still = {
        (growth, density): results.derive(_Moments, design.still(settings, growth, density))
        for growth in design.growths()
        for density in design.densities
    }
    loops = {
        (growth, kind): results.derive(_Loops, make(settings, growth))
        for growth in design.growths()
        for kind, make in (("noise", design.noise_loop), ("density", design.density_loop))
    }
    notes, claims = [], []
    for way in WAYS:
        sizes = [growth for growth in design.growths() if growth.way == way]
        judged = [_judge(design, still, loops, growth) for growth in sizes]
        larger = judged[len(judged) // 2 :]
        notes.append(f"Growing the {way}: {conclusion([c for pair in larger for c in pair])}.")
        claims += [claim for pair in judged for claim in pair]
    notes.append(
        "Density: boats for each free area of the pool 500-boats. In loops, solid lines: the way "
        "there (density or bw rising); dashed: back. Intervals of loops are Student's over seeds."
    )
    notes.append(_budget_note(design, settings))
    tables = {"transition": _points_table(still), "loops": _loops_table(loops)}
    tables["histograms"] = _histograms(still)
    return Outcome(tables, {"transition": _picture(design, still, loops)}, claims, notes)


def _budget_note(design: TransitionDesign, settings: Settings) -> str:
    still, loop = (settings.duration_s(m) / 60 for m in (design.still_minutes, design.loop_minutes))
    return (
        f"Compute budget: {settings.budget_core_min:g} minutes of one core. This design: "
        f"{design.runs} seeds, {still:g} minutes a run and {loop:g} minutes a loop, "
        f"{len(design.sizes)} sizes up to {max(design.sizes)} boats, estimated to take "
        f"{design.core_minutes(settings):.0f}; the full one takes "
        f"{FULL.core_minutes(settings):.0f} (`--budget`). A loop that is open only because it was "
        "run too fast looks the same."
    )


def _judge(
    design: TransitionDesign,
    still: dict[tuple[Growth, int], _Moments],
    loops: dict[tuple[Growth, str], _Loops],
    growth: Growth,
) -> tuple[CheckedClaim, CheckedClaim]:
    scope = f"{growth.n_boats} boats, {growth.way}"
    # The density is chosen once, by the data as measured.
    lowest = min(
        (still[growth, density].binder_m for density in design.densities),
        key=lambda cumulants: np.nan_to_num(cumulants[0], nan=np.inf),
    )
    opening = loops[growth, "density"].opening
    return COEXISTENCE.check(*interval(lowest), scope), HYSTERESIS.check(*opening, scope)


def _points_table(still: dict[tuple[Growth, int], _Moments]) -> pd.DataFrame:
    rows = []
    for (growth, density), moments in still.items():
        row: dict[str, object] = {"way": growth.way, "n_boats": growth.n_boats, "density": density}
        for name in ("m", "c_v", "binder_m", "binder_c_v"):
            value, low, high = interval(getattr(moments, name))
            row |= {name: value, f"{name}_low": low, f"{name}_high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def _loops_table(loops: dict[tuple[Growth, str], _Loops]) -> pd.DataFrame:
    tables = []
    for (growth, kind), loop in loops.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "loop": kind}
        value, low, high = loop.opening
        columns = {"position": CENTRES, "there": loop.there, "back": loop.back}
        ends = {"opening": value, "opening_low": low, "opening_high": high}
        tables.append(pd.DataFrame({**keys, **columns, **ends}))
    return pd.concat(tables)


def _histograms(still: dict[tuple[Growth, int], _Moments]) -> pd.DataFrame:
    tables = []
    for (growth, density), moments in still.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "density": density}
        for name, edges in (("m", M_EDGES), ("c_v", _C_V_EDGES)):
            bins = {"bin_low": edges[:-1], "bin_high": edges[1:]}
            heights = {"probability_density": getattr(moments, f"{name}_density")}
            tables.append(pd.DataFrame({**keys, "quantity": name, **bins, **heights}))
    return pd.concat(tables)


def _picture(
    design: TransitionDesign,
    still: dict[tuple[Growth, int], _Moments],
    loops: dict[tuple[Growth, str], _Loops],
) -> Figure:
    with paper_style():
        picture = column_figure(16.0)
        panels = picture.subplots(4, len(WAYS), sharey="row")
        for column, way in enumerate(WAYS):
            panels[0, column].set_title(f"growing the {way}")
            for place, n in enumerate(design.sizes):
                growth, color = Growth(way, n), COLORS[place % len(COLORS)]
                _draw_binder(panels[0, column], design, still, growth, color)
                for row, kind in ((1, "density"), (2, "noise")):
                    _draw_loop(panels[row, column], loops[growth, kind], color)
            _draw_openings(panels[3, column], design, loops, way)
        panels[0, 0].legend(title="boats", ncols=2)
        panels[0, 0].set_ylabel("Binder cumulant of m")
        for row, kind in ((1, "density"), (2, "noise")):
            panels[row, 0].set_ylabel("mean |m|")
            for axes in panels[row]:
                axes.set_xlabel(f"place in loop of {kind}")
        for axes in panels[0]:
            axes.set_xlabel("density (boats / pool)")
        panels[3, 0].set_ylabel("opening of loops")
        panels[3, 0].legend()
    return picture


def _draw_binder(
    axes: Axes,
    design: TransitionDesign,
    still: dict[tuple[Growth, int], _Moments],
    growth: Growth,
    color: str,
) -> None:
    ends = np.array([interval(still[growth, density].binder_m) for density in design.densities])
    axes.plot(design.densities, ends[:, 0], "o-", color=color, label=str(growth.n_boats))
    axes.fill_between(design.densities, ends[:, 1], ends[:, 2], color=color, alpha=0.15, lw=0)


def _draw_loop(axes: Axes, loop: _Loops, color: str) -> None:
    axes.plot(CENTRES, loop.there, "-", color=color)
    axes.plot(CENTRES, loop.back, "--", color=color)


def _draw_openings(
    axes: Axes,
    design: TransitionDesign,
    loops: dict[tuple[Growth, str], _Loops],
    way: str,
) -> None:
    for kind, mark, color in (("density", "o-", COLORS[0]), ("noise", "^--", COLORS[1])):
        ends = np.array([loops[Growth(way, n), kind].opening for n in design.sizes])
        bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
        axes.errorbar(design.sizes, ends[:, 0], bars, fmt=mark, color=color, label=kind)
    axes.set_xscale("log")
    axes.set_xticks(design.sizes, [str(n) for n in design.sizes])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("boats")


def transition_order(design: TransitionDesign | None = None) -> Reproduction:
    """Return the reproduction, by default in the largest design that the budget allows."""

    def chosen(settings: Settings) -> TransitionDesign:
        return within(settings) if design is None else design

    return Reproduction(
        name="transition-order",
        title="Is the jamming–order transition of first order?",
        section="5.2, left open",
        runs=lambda settings: chosen(settings).all_runs(settings),
        analyse=lambda settings, results: _analyse(chosen(settings), settings, results),
    )


REPRODUCTIONS = (transition_order(),)
