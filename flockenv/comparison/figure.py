"""Figures. Nothing upstream imports this module."""

import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv._io.atomic_write import atomic_write
from flockenv.comparison.episodes import NO_LEADERS
from flockenv.statistics import Line

__all__ = ["COLORS", "POLICY_COLORS", "leader_curve", "policy_colors"]

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Okabe and Ito's colors, which every kind of eye distinguishes."""

POLICY_COLORS: Mapping[str, str] = {
    NO_LEADERS: "#555555",
    "steering law": COLORS[0],
    "tuned damped law": COLORS[1],
    "learned": COLORS[2],
    "tuned sign-corrected law": COLORS[3],
    "damped law": COLORS[4],
    "sign-corrected law": COLORS[5],
    "steering law at every substep": "#332288",
    "straight ahead": "#882255",
    "random rudders": "#999933",
}
"""The color that a policy has in every figure."""

# Of Tol's muted set, for policies of the user's own.
_OTHERS = ("#44aa99", "#117733", "#aa4499", "#661100", "#6699cc", "#888888")

_LONGEST_LABEL = 40

_LABELS = {
    "psi_o": r"mean $\Psi_o$",
    "signed_order": r"mean signed order $\Psi_o\,\cos(\varphi_o-\varphi_\mathrm{target})$",
}


def policy_colors(names: Iterable[str]) -> dict[str, str]:
    """Return a color for each policy: its own in `POLICY_COLORS`, or the next that none has."""
    names = list(dict.fromkeys(names))
    others = itertools.cycle(_OTHERS)
    return {name: POLICY_COLORS.get(name) or next(others) for name in names}


def leader_curve(
    runs: pd.DataFrame | None,
    means: pd.DataFrame,
    lines: Mapping[tuple[str, str], Line],
    title: str,
    path: Path,
) -> None:
    """Draw order against the number of leaders, as figure 12 does.

    Parameters
    ----------
    runs
        One row per episode, of `compare_leaders`; None draws no dots for episodes.
    means
        Its means and intervals by policy and number of leaders, of `summarize`.
    lines
        The fitted line for each (policy, quantity) that has one.
    title
        What was run.
    path
        Where to write the picture; the suffix decides its format.
    """
    policies = [name for name in means["policy"].unique() if name != NO_LEADERS]
    colors = policy_colors(policies)
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(7.5, 4.0), layout="constrained")
        for axes, quantity in zip(figure.subplots(1, 2), _LABELS, strict=True):
            for place, policy in enumerate(policies):
                shown = _Shown(runs, means, [policy, NO_LEADERS], quantity)
                shift = 0.1 * (place - (len(policies) - 1) / 2)
                line = lines.get((policy, quantity))
                _draw_policy(axes, shown, line, shift, colors[policy])
            axes.set_xlabel("number of leaders k")
            axes.set_ylabel(_LABELS[quantity])
            axes.set_xticks(sorted(means["leaders"].unique()))
            # Below: the episodes fill the panel.
            legend = axes.legend(
                frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8
            )
            # Policies may have the names of files: a dollar sign there starts no formula.
            for text in legend.get_texts():
                text.set_parse_math(False)
        figure.suptitle(title, fontsize=9, parse_math=False)
        with atomic_write(path) as file:
            figure.savefig(file, dpi=200, format=path.suffix.removeprefix("."))


def _legend_label(policy: str) -> str:
    """Shorten a long path to its end, so that the legend leaves room for the panels."""
    if len(policy) > _LONGEST_LABEL:
        return "…" + policy[1 - _LONGEST_LABEL :]
    # A legend leaves out labels that start with an underscore.
    return f" {policy}" if policy.startswith("_") else policy


class _Shown:
    """One quantity of one policy: episodes, means by number of leaders, and their intervals."""

    def __init__(
        self, runs: pd.DataFrame | None, means: pd.DataFrame, policies: list[str], quantity: str
    ) -> None:
        self.label = _legend_label(policies[0])
        runs = means.iloc[:0] if runs is None else runs[runs["policy"].isin(policies)]
        means = means[means["policy"].isin(policies)].sort_values("leaders")
        self.leaders, self.values = runs["leaders"].to_numpy(), runs[quantity].to_numpy()
        self.k, self.mean = means["leaders"].to_numpy(), means[quantity].to_numpy()
        ends = means[[f"{quantity}_low", f"{quantity}_high"]].to_numpy().T
        self.spread = abs(ends - self.mean)


def _draw_policy(axes: Axes, shown: _Shown, line: Line | None, shift: float, color: str) -> None:
    axes.plot(shown.leaders + shift, shown.values, ".", ms=3, alpha=0.3, color=color, mew=0)
    axes.errorbar(
        shown.k + shift,
        shown.mean,
        shown.spread,
        fmt="o",
        ms=4,
        lw=1,
        capsize=3,
        color=color,
        label=shown.label if line is None else None,
    )
    if line is None:
        return
    x = np.array([shown.k.min(), shown.k.max()])
    y = line.intercept + line.slope * x
    label = "no line to fit" if np.isnan(line.f) else f"F = {line.f:.1f}, p = {line.p:.1g}"
    axes.plot(x, y, "-", lw=1, color=color, label=f"{shown.label}: {label}")
