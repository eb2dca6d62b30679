"""The plots of the README and of the page about leaders."""

from committed_data import DIFFERENCES, MEANS, Row, rows
from interval_plots import Plot, across, listed
from matplotlib.figure import Figure

LADDER = ("learned", "tuned law", "damped law", "paper's law")
POOLS = {"wide": "wide-bw-0.31", "narrow": "narrow-bw-0.45"}
COUNT = "leaders/leader_count.csv"
CLOSE = "leaders/close_differences.csv"


def leader_count(figure: Figure) -> None:
    """Draw what `make compare` prints."""
    axes = figure.subplots()
    laws = [row for name in LADDER if name != "damped law" for row in rows(COUNT, policy=name)]
    across(axes, (row for row in laws if row["leaders"] != "slope"), "leaders")
    across(axes, rows(COUNT, policy="no leaders"), "leaders")
    axes.set(xlabel="leaders among 27 boats", ylabel="signed order", xticks=range(5))
    axes.legend(loc="upper left")


def both_pools(figure: Figure) -> None:
    """Draw the order by the number of leaders in both pools."""
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (pool, case) in zip(panels, POOLS.items(), strict=True):
        across(
            axes, (row for name in LADDER for row in rows(MEANS, case=case, policy=name)), "leaders"
        )
        axes.set(title=pool, xlabel="leaders among 27 boats", xticks=range(1, 5))
    panels[0].set_ylabel("signed order")
    panels[0].legend(loc="upper left")


def learned_minus_tuned(figure: Figure) -> None:
    """Draw what learning adds to the tuned law, in the larger of the two sets of flocks."""
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (pool, case) in zip(panels, POOLS.items(), strict=True):
        listed(axes, {k: _added(case, k) for k in "1234"}, dict.fromkeys("1234", "0.15"), 0.0)
        axes.set(title=pool, xlabel="learned minus tuned law")
    panels[0].set_ylabel("leaders")


def _added(case: str, leaders: str) -> tuple[float, float, float]:
    found = {(row["case"], row["leaders"]): row for row in rows(CLOSE, policy="learned")}
    row: Row | None = found.get((case, leaders))
    if row is None:
        (row,) = rows(
            DIFFERENCES, case=case, leaders=leaders, policy="learned", reference="tuned law"
        )
    return float(row["mean"]), float(row["low"]), float(row["high"])


PLOTS = {
    "leaders/leader_count.png": Plot([COUNT], leader_count),
    "leaders/both_pools.png": Plot([MEANS], both_pools, (8.4, 4.2)),
    "leaders/learned_minus_tuned.png": Plot([CLOSE, DIFFERENCES], learned_minus_tuned, (8.4, 2.6)),
}
"""How each is drawn, by its file below docs."""
