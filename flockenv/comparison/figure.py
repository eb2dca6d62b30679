"""Figures. Nothing upstream imports this module."""

import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv._io.atomic_write import atomic_write
from flockenv.comparison.episodes import NO_LEADERS

__all__ = ["COLORS", "POLICY_COLORS", "leader_curve", "policy_colors"]

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Okabe and Ito's colors, which every kind of eye distinguishes."""

POLICY_COLORS: Mapping[str, str] = {
    NO_LEADERS: "#555555",
    "paper's law": "#0072b2",
    "tuned law": "#e69f00",
    "learned": "#009e73",
    "damped law": "#56b4e9",
    "paper's law at every substep": "#332288",
    "straight ahead": "#882255",
    "random rudders": "#ddcc77",
}
"""The color that a named policy has in every figure."""

_OWN = ("#d55e00", "#cc79a7", "#661100", "#6699cc", "#999999", "#bbbb00")
"""Colors for policies of the user's own, none of them a shade of a named one."""

_LONGEST_LABEL = 40
_ORDER = r"mean signed order $\Psi_o\,\cos(\varphi_o-\varphi_\mathrm{target})$"


def policy_colors(names: Iterable[str]) -> dict[str, str]:
    """Return a color for each policy: its own in `POLICY_COLORS`, or the next that none has."""
    names = list(dict.fromkeys(names))
    others = itertools.cycle(_OWN)
    return {name: POLICY_COLORS.get(name) or next(others) for name in names}


def leader_curve(
    means: pd.DataFrame,
    path: Path,
    *,
    runs: pd.DataFrame | None = None,
    titles: Mapping[str, str] | None = None,
) -> None:
    """Draw order against the number of leaders, as figure 12 does, a panel for each case.

    Parameters
    ----------
    means
        Means and intervals by case, policy and number of leaders, as in a `ComparisonReport`.
    path
        Where to write the picture; the suffix decides its format.
    runs
        One row per episode, to be drawn as dots.
    titles
        What was run, by case.
    """
    policies = [name for name in means["policy"].unique() if name != NO_LEADERS]
    colors, cases = policy_colors(policies), list(means["case"].unique())
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(0.6 + 3.6 * len(cases), 4.0), layout="constrained")
        panels = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
        for axes, case in zip(panels, cases, strict=True):
            own = means[means["case"] == case]
            dots = None if runs is None else runs[runs["case"] == case]
            for place, policy in enumerate(policies):
                shift = 0.1 * (place - (len(policies) - 1) / 2)
                _draw_policy(axes, own, dots, policy, shift, colors[policy])
            axes.set_xlabel("number of leaders k")
            axes.set_xticks(sorted(own["leaders"].unique()))
            title = (titles or {}).get(case, case).replace(", ", "\n", 1)
            axes.set_title(title, fontsize=8, parse_math=False, wrap=True)
        panels[0].set_ylabel(_ORDER)
        handles, labels = panels[0].get_legend_handles_labels()
        legend = figure.legend(handles, labels, frameon=False, loc="outside lower center", ncols=3)
        # Policies may have the names of files: a dollar sign there starts no formula.
        for text in legend.get_texts():
            text.set_parse_math(False)
        with atomic_write(path) as file:
            figure.savefig(file, dpi=200, format=path.suffix.removeprefix("."))


def _draw_policy(
    axes: Axes,
    means: pd.DataFrame,
    runs: pd.DataFrame | None,
    policy: str,
    shift: float,
    color: str,
) -> None:
    names = [policy, NO_LEADERS]
    if runs is not None:
        dots = runs[runs["policy"].isin(names)]
        k, orders = dots["leaders"] + shift, dots["signed_order"]
        axes.plot(k, orders, ".", ms=3, alpha=0.3, color=color, mew=0)
    shown = means[means["policy"].isin(names)].sort_values("leaders")
    ends = shown[["signed_order_low", "signed_order_high"]].to_numpy().T
    axes.errorbar(
        shown["leaders"] + shift,
        shown["signed_order"],
        abs(ends - shown["signed_order"].to_numpy()),
        fmt="o-",
        ms=4,
        lw=1,
        capsize=3,
        color=color,
        label=_legend_label(policy),
    )


def _legend_label(policy: str) -> str:
    """Shorten a long path to its end, so that the legend leaves room for the panels."""
    if len(policy) > _LONGEST_LABEL:
        return "…" + policy[1 - _LONGEST_LABEL :]
    # A legend leaves out labels that start with an underscore.
    return f" {policy}" if policy.startswith("_") else policy
