"""The leader-count curve: order against the number of leaders."""

import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv._io.atomic_write import atomic_write
from flockenv.comparison.episodes import NO_LEADERS
from flockenv.policies.names import LAWS
from flockenv.rendering.palette import OKABE_ITO
from flockenv.statistics import CONFIDENCE

COLORS = {name: law["color"] for name, law in LAWS.items() if law["color"]}
"""The color that a policy has in every figure."""

_OKABE_ITO = [OKABE_ITO[name] for name in ("vermilion", "purple", "sky blue", "blue")]
# The last two are not of Okabe and Ito's palette, and no law has them.
OTHER_COLORS = (*_OKABE_ITO, "#999933", "#ddcc77")
"""Colors of other policies, in turn."""

_ORDER = r"mean signed order $\Psi_o\,\cos(\varphi_o-\varphi_\mathrm{target})$"


def policy_colors(names: Iterable[str]) -> dict[str, str]:
    """Return a color for each policy: by its name in `COLORS`, or the next of `OTHER_COLORS`."""
    others = itertools.cycle(OTHER_COLORS)
    return {name: COLORS.get(name) or next(others) for name in names}


def leader_curve(
    means: pd.DataFrame,
    path: Path,
    *,
    runs: pd.DataFrame | None = None,
    titles: Mapping[str, str] | None = None,
) -> None:
    """Draw order against the number of leaders, as figure 12 does, a panel for each case.

    `means` and `runs` are those of a `ComparisonReport`; each run is a dot. `titles` holds the
    panels' titles by case.
    """
    policies = [name for name in means["policy"].unique() if name != NO_LEADERS]
    cases = list(means["case"].unique())
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(0.6 + 3.6 * len(cases), 4.0), layout="constrained")
        panels = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
        for axes, case in zip(panels, cases, strict=True):
            case_means = means[means["case"] == case]
            for index, (policy, color) in enumerate(policy_colors(policies).items()):
                shift = 0.1 * (index - (len(policies) - 1) / 2)
                # At k = 0 every policy has the same flocks.
                names = [policy, NO_LEADERS]
                if runs is not None:
                    dots = runs[(runs["case"] == case) & runs["policy"].isin(names)]
                    k = dots["leaders"] + shift
                    axes.plot(k, dots["signed_order"], ".", ms=3, alpha=0.3, color=color, mew=0)
                policy_means = case_means[case_means["policy"].isin(names)]
                _draw_policy(axes, policy_means, shift, policy, color)
            axes.set_xlabel("number of leaders k")
            axes.set_xticks(sorted(case_means["leaders"].unique()))
            title = (titles or {}).get(case, case).replace(", ", "\n", 1)
            axes.set_title(title, fontsize=8, parse_math=False, wrap=True)
        panels[0].set_ylabel(_ORDER)
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            frameon=False,
            loc="outside lower center",
            ncols=3,
            title=f"bars: {CONFIDENCE:.0%} intervals of the mean",
        )
        with atomic_write(path) as file:
            figure.savefig(file, dpi=200, format=path.suffix.removeprefix("."))


def _draw_policy(axes: Axes, means: pd.DataFrame, shift: float, policy: str, color: str) -> None:
    """Draw the means of a policy with their intervals, shifted along the axis of leaders."""
    means = means.sort_values("leaders")
    order = means["signed_order"]
    bounds = means[["signed_order_low", "signed_order_high"]]
    bar_lengths = bounds.sub(order, axis=0).abs().to_numpy().T
    # A policy may have the name of a file. A dollar sign in it must not start a formula. The space
    # in front is for names that start with an underscore: Matplotlib's legends leave them out.
    label = " " + policy[-40:].replace("$", r"\$")
    axes.errorbar(
        means["leaders"] + shift,
        order,
        bar_lengths,
        fmt="o-",
        ms=4,
        lw=1,
        capsize=3,
        color=color,
        label=label,
    )
