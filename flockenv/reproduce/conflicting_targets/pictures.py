"""The pictures of `conflicting-targets`: order and time by majority, and how rotation spreads."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv.comparison.figure import policy_colors
from flockenv.reproduce.conflicting_targets.design import (
    AGAINST,
    LEADERLESS,
    POOLS,
    ConflictDesign,
    Match,
    Setup,
)
from flockenv.reproduce.conflicting_targets.measured import MOVING, WON, Measured
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.statistics.intervals import interval, student_interval

__all__ = ["histograms", "picture"]

_BOATS = 27
_MOST = 6
_SHOWN: tuple[Match, ...] = (LEADERLESS, (3, 3), (4, 2))

Found = Mapping[tuple[Setup, Match], Measured]


def _alike(design: ConflictDesign) -> list[str]:
    return [policy for policy in design.policies if policy != AGAINST]


def picture(design: ConflictDesign, found: Found, n_boats: int) -> Figure:
    """Return order and time against the majority in one size; one column for each pool."""
    with paper_style():
        figure = column_figure(10.5)
        panels = figure.subplots(2, len(POOLS), sharex=True, sharey="row")
        for column, pool in enumerate(POOLS):
            above, below = panels[:, column]
            above.set_title(pool)
            above.axhline(0.0, color="0.6", lw=0.6, zorder=0)
            for policy, color in policy_colors(_alike(design)).items():
                _draw_majorities(above, below, found, Setup(policy, pool, n_boats), color)
            below.set_xlabel(r"majority $(k_1-k_2)/(k_1+k_2)$")
        panels[0, 0].set_ylabel("mean signed order")
        panels[1, 0].set_ylabel(f"minutes until it is {WON:g}")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _draw_majorities(above: Axes, below: Axes, found: Found, setup: Setup, color: str) -> None:
    own = {m: each for (other, m), each in found.items() if other == setup and m != LEADERLESS}
    # Filled and joined: the most leaders; open: fewer.
    for is_full in (True, False):
        chosen = {
            (k1 - k2) / (k1 + k2): each
            for (k1, k2), each in own.items()
            if (k1 + k2 == _MOST * setup.scale) == is_full
        }
        orders = [student_interval(each.signed_order) for each in chosen.values()]
        times = [interval(each.means["decision_min"]) for each in chosen.values()]
        for axes, ends in ((above, orders), (below, times)):
            middle, low, high = np.array(ends).T
            axes.errorbar(
                list(chosen),
                middle,
                np.abs([middle - low, high - middle]),
                fmt="o-" if is_full else "o",
                color=color,
                mfc=color if is_full else "white",
                elinewidth=0.6,
                label=setup.policy if is_full else None,
            )


def histograms(design: ConflictDesign, found: Found) -> Figure:
    """Return how often the minutes' rotation has which value; a row for each policy."""
    policies = _alike(design)
    edges = np.linspace(-1.0, 1.0, 41)
    with paper_style():
        figure = column_figure(2.0 + 3.0 * len(policies))
        panels = figure.subplots(len(policies), len(POOLS), sharex=True, squeeze=False)
        for row, policy in enumerate(policies):
            for column, pool in enumerate(POOLS):
                axes = panels[row, column]
                for place, match in enumerate(_SHOWN):
                    late = found[Setup(policy, pool, _BOATS), match].late
                    label = f"{match[0]} against {match[1]}" if sum(match) else "no leaders"
                    axes.hist(
                        late, edges, density=True, histtype="step", color=COLORS[place], label=label
                    )
                for edge in (-MOVING, MOVING):
                    axes.axvline(edge, color="0.7", lw=0.5, zorder=0)
                axes.set_title(f"{policy}, {pool}")
                axes.set_yticks([])
        for axes in panels[-1]:
            axes.set_xlabel(r"rotation $m$")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure
