"""The picture of `leader-fraction`: curves by policy and size, and the guiding fractions."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv.comparison.figure import policy_colors
from flockenv.reproduce.leader_fraction.design import FractionDesign
from flockenv.reproduce.leader_fraction.measured import GUIDED, Curve
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.reproduce.transition.design import WAYS, Growth
from flockenv.statistics.intervals import interval, student_interval

__all__ = ["picture"]


def picture(design: FractionDesign, curves: Mapping[tuple[str, Growth], Curve]) -> Figure:
    """Return the picture; one column for each way of growing."""
    with paper_style():
        policies = design.policies
        figure = column_figure(6.5 + 4.5 * len(policies))
        panels = figure.subplots(len(policies) + 1, len(WAYS), sharey="row")
        has_any = any(np.isfinite(curve.replicates[0]) for curve in curves.values())
        for column, way in enumerate(WAYS):
            *above, below = panels[:, column]
            above[0].set_title(f"{way} grows")
            for axes, policy in zip(above, policies, strict=True):
                for place, n in enumerate(design.sizes):
                    _draw_curve(axes, curves[policy, Growth(way, n)], COLORS[place])
                axes.axhline(GUIDED, color="0.6", lw=0.6, zorder=0)
                axes.set_xscale("log")
            above[-1].set_xlabel("proportion of leaders")
            for policy, color in policy_colors(design.policies).items():
                found = [curves[policy, Growth(way, n)] for n in design.sizes]
                _draw_fractions(below, found, policy, color)
            below.set_xscale("log")
            if has_any:
                below.set_yscale("log")
            below.set_xticks(list(design.sizes), [str(n) for n in design.sizes])
            below.set_xticks([], minor=True)
            below.set_xlabel("boats")
        # Intervals of a few runs would reach beyond what the order can be.
        for axes, policy in zip(panels[:, 0], policies, strict=False):
            axes.set_ylim(-1.05, 1.05)
            axes.set_ylabel(f"signed order, {policy}")
        panels[-1, 0].set_ylabel(f"proportion for a signed order of {GUIDED:g}")
        figure.legend(
            *panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2
        )
        figure.legend(
            *panels[-1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3
        )
    return figure


def _draw_curve(axes: Axes, curve: Curve, color: str) -> None:
    ends = np.array([student_interval(values) for values in curve.signed_order.values()])
    fractions = np.array(list(curve.signed_order)) / curve.n_boats
    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
    label = f"{curve.n_boats} boats"
    axes.errorbar(fractions, ends[:, 0], bars, fmt="o-", color=color, elinewidth=0.6, label=label)


def _draw_fractions(axes: Axes, curves: list[Curve], policy: str, color: str) -> None:
    ends = np.array([interval(curve.replicates) for curve in curves])
    bars = np.abs([ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]])
    n = [curve.n_boats for curve in curves]
    axes.errorbar(n, ends[:, 0], bars, fmt="o-", color=color, elinewidth=0.6, label=policy)
