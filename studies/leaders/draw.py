"""Draw the order by the number of leaders, and what learning adds."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Interval, Plot, listed, one, rows
from studies.plots import across, drawing, interval
from studies.study import main

RESULTS = Path(__file__).parent / "results"
MEANS, DIFFERENCES = RESULTS / "means.csv", RESULTS / "differences.csv"
COUNT, CLOSE = RESULTS / "leader_count.csv", RESULTS / "close_differences.csv"
TUNED, LEARNED = "tuned law", "learned"
LADDER = (LEARNED, TUNED, "damped law", "paper's law")
CASES = {"wide": "wide-bw-0.31", "narrow": "narrow-bw-0.45"}
"""The comparisons of each pool, at the noise that the pages show."""


def leader_count(figure: Figure) -> None:
    """Draw what `make compare` prints."""
    axes = figure.subplots()
    laws = (row for name in LADDER if name != "damped law" for row in rows(COUNT, policy=name))
    across(axes, laws, "leaders")
    across(axes, rows(COUNT, policy="no leaders"), "leaders")
    axes.set(xlabel="leaders among 27 boats", ylabel="signed order", xticks=range(5))
    axes.legend(loc="upper left")


def both_pools(figure: Figure) -> None:
    """Draw the order by the number of leaders in both pools."""
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (pool, case) in zip(panels, CASES.items(), strict=True):
        names = LADDER if pool == "wide" else LADDER[1:]
        across(
            axes, (row for name in names for row in rows(MEANS, case=case, policy=name)), "leaders"
        )
        axes.set(title=pool, xlabel="leaders among 27 boats", xticks=range(1, 5))
    panels[0].set_ylabel("signed order")
    panels[0].legend(loc="upper left")


def learned_minus_tuned(figure: Figure) -> None:
    """Draw what learning adds to the tuned law, in the larger of the two sets of flocks."""
    axes, found = figure.subplots(), _added(CASES["wide"])
    listed(axes, found, dict.fromkeys(found, "0.15"), 0.0)
    axes.set(xlabel="learned minus tuned law", ylabel="leaders")


def _added(case: str) -> dict[str, Interval]:
    close = {(row["case"], row["leaders"]): row for row in rows(CLOSE, policy=LEARNED)}
    other = {"case": case, "policy": LEARNED, "reference": TUNED}
    few = {k: one(DIFFERENCES, leaders=k, **other) for k in "1234"}
    return {k: interval(close.get((case, k), few[k])) for k in "1234"}


PLOTS = {
    "leader_count": Plot([COUNT], leader_count, (6.0, 3.8)),
    "both_pools": Plot([MEANS], both_pools, (8.4, 4.2)),
    "learned_minus_tuned": Plot([CLOSE, DIFFERENCES], learned_minus_tuned, (6.8, 2.4)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
