"""The plots of the README and of the page about leaders."""

from committed_data import DIFFERENCES, MEANS, Row, one, rows
from interval_plots import Interval, Plot, across, grouped, listed
from leader_words import CASES, CLOSE, LEARNED, TUNED, planned
from matplotlib.figure import Figure

from flockenv.statistics import student_interval

LADDER = (LEARNED, TUNED, "damped law", "paper's law")
COUNT = "leaders/leader_count.csv"
MOTION = "leaders/motion.csv"
BEYOND = "leaders/beyond.csv"
GAINS = "leaders/tuned_laws/gains.csv"
PLANS = {"planner, noise known": "known", "planner, noise unknown": "fresh"}


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


def tuned_laws(figure: Figure) -> None:
    """Draw what a search for each number of leaders adds to the tuned law."""
    ends = ("beyond", "beyond_low", "beyond_high")
    found = {pool: {row["leaders"]: row for row in rows(GAINS, pool=pool)} for pool in CASES}
    shown = {
        pool: {k: _ends(row, *ends) for k, row in each.items()} for pool, each in found.items()
    }
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (pool, gains) in zip(panels, shown.items(), strict=True):
        listed(axes, gains, dict.fromkeys(gains, "0.15"), 0.0)
        axes.set(title=pool, xlabel="searched gains minus tuned law")
    panels[0].set_ylabel("leaders")


def beyond(figure: Figure) -> None:
    """Draw what learned leaders add to the tuned law in other flocks than those of the training."""
    axes = figure.subplots()
    found = {
        " ".join({row["what"]: 0, row["value"]: 0}): _ends(row, "gain", "gain_low", "gain_high")
        for row in rows(BEYOND)
    }
    listed(axes, found, dict.fromkeys(found, "0.15"), 0.0)
    axes.set(xlabel="learned minus tuned law", xticks=(-0.05, 0.0, 0.05, 0.1))


def _added(case: str) -> dict[str, Interval]:
    close = {(row["case"], row["leaders"]): row for row in rows(CLOSE, policy=LEARNED)}
    other = {"case": case, "policy": LEARNED, "reference": TUNED}
    few = {k: one(DIFFERENCES, leaders=k, **other) for k in "1234"}
    return {k: _ends(close.get((case, k), few[k])) for k in "1234"}


def _ends(row: Row, mean: str = "mean", low: str = "low", high: str = "high") -> Interval:
    return float(row[mean]), float(row[low]), float(row[high])


def plans(figure: Figure) -> None:
    """Draw what the learned leaders and both planners reach, and what planning adds."""
    left, right = figure.subplots(1, 2, sharey=True)
    orders = {name: planned(noise) for name, noise in PLANS.items()}
    (learned, _), *_ = orders.values()
    means, gains = {LEARNED: student_interval(learned)}, {LEARNED: (0.0, 0.0, 0.0)}
    for name, (own, plan) in orders.items():
        means[name], gains[name] = student_interval(plan), student_interval(plan - own)
    listed(left, means)
    listed(right, gains, reference=0.0)
    left.set(xlabel="signed order", xlim=(0, 1))
    right.set(xlabel="minus learned")


SHOWN = {
    "in the row at the wall": "at_wall",
    "beside that row": "beside_wall",
    "close to a leader": "beside_leader",
    "heading, mean cosine": "alignment",
}
"""What the plot of motion shows: shares of the time, and how close to the target leaders head."""


def motion(figure: Figure) -> None:
    """Draw where leaders are and how they head."""
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, pool in zip(panels, CASES, strict=True):
        found = {
            row["policy"]: {
                words: _ends(row, name, f"{name}_low", f"{name}_high")
                for words, name in SHOWN.items()
            }
            for row in rows(MOTION, pool=pool)[::-1]
        }
        grouped(axes, found)
        axes.set(title=pool, xlabel="share of the time, or cosine", xlim=(0, 1))
    panels[0].legend(loc="lower left", fontsize=9)


PLOTS = {
    "leaders/leader_count.png": Plot([COUNT], leader_count),
    "leaders/both_pools.png": Plot([MEANS], both_pools, (8.4, 4.2)),
    "leaders/learned_minus_tuned.png": Plot([CLOSE, DIFFERENCES], learned_minus_tuned, (6.8, 2.4)),
    "leaders/beyond.png": Plot([BEYOND], beyond, (6.8, 6.2)),
    "leaders/tuned_laws.png": Plot([GAINS], tuned_laws, (8.4, 2.6)),
    "leaders/plans.png": Plot(
        ["leaders/plan_known.csv", "leaders/plan_fresh.csv"], plans, (8.4, 2.2)
    ),
    "leaders/motion.png": Plot([MOTION], motion, (8.4, 3.4)),
}
"""How each is drawn, by its file below docs."""
