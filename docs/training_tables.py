"""The tables of docs/train.md: what trainings, their searches and signals of rewards gave."""

from collections.abc import Mapping
from functools import partial

from committed_data import (
    DIFFERENCES,
    MEANS,
    POOLS,
    difference,
    interval,
    markdown,
    one,
    order,
    rows,
)


def ppo_comparison() -> str:
    """Return the order with PPO's best policy and three leaders."""
    body = []
    for pool, scene in zip(POOLS, ("500-boats-bw-0.31", "table-1-bw-0.45"), strict=True):
        mean = one(MEANS, comparison="ppo", scene=scene, policy="best")
        gains = [
            one(DIFFERENCES, comparison="ppo", scene=scene, policy="best", reference=law)
            for law in ("damped law", "tuned damped law")
        ]
        body.append([f"`{pool}`", order(mean), *(difference(row) for row in gains)])
    header = ["pool", "PPO", "minus the damped law", "minus the tuned damped law"]
    return markdown(header, body)


def first_training() -> str:
    """Return what the first training run of docs/train.md adds to the law that it started from."""
    body = []
    for k in ("1", "2", "3"):
        means = (
            one(MEANS, comparison="first-training", policy=name, leaders=k)
            for name in ("damped law", "best")
        )
        gain = one(DIFFERENCES, comparison="first-training", policy="best", leaders=k)
        body.append([k, *(order(row) for row in means), difference(gain)])
    return markdown(["leaders", "damped law", "trained", "trained minus damped law"], body)


def signals() -> str:
    """Return z per million samples of each reward and horizon, for rudders."""
    return _signals({"": "results/signals.csv"})


def lean_signals() -> str:
    """Return z per million samples of each reward and horizon, for leans."""
    noises = ("own", "shared")
    return _signals({f"{noise} noise, ": f"results/signals_lean_{noise}.csv" for noise in noises})


def _signals(files: Mapping[str, str]) -> str:
    """Return what `flockenv signal` measured; files stand by how their titles start."""
    every = {title: rows(file) for title, file in files.items()}
    (first, *_) = every.values()
    horizons = list(dict.fromkeys(row["horizon_s"] for row in first))
    body = []
    for pool, reward_name in dict.fromkeys((row["pool"], row["reward"]) for row in first):
        each = (
            one(file, pool=pool, reward=reward_name, horizon_s=horizon)
            for file in files.values()
            for horizon in horizons
        )
        cells = (f"{float(row['z_per_million']):+.1f} ± {float(row['error']):.1f}" for row in each)
        body.append([f"`{pool}`", f"`{reward_name}`", *cells])
    titles = [f"{title}horizon {float(each):g} s" for title in files for each in horizons]
    return markdown(["pool", "reward", *titles], body)


def trained(pool: str) -> str:
    """Return the held-out orders of `flockenv train --seeds`."""
    file = f"training/{pool}/evaluation.csv"
    laws = ("damped law", "tuned damped law", "learned")
    body = []
    for policy in dict.fromkeys(row["policy"] for row in rows(file)):
        found = [one(file, policy=policy, minus="")]
        found += [] if policy in laws else [one(file, policy=policy, minus=law) for law in laws]
        forms = (".3f", *["+.3f"] * len(laws))
        cells = [
            interval(row, "signed_order", "low", "high", form)
            for row, form in zip(found, forms, strict=False)
        ]
        body.append([policy, *cells, *[""] * (len(forms) - len(cells))])
    return markdown(["policy", "signed order", *(f"minus {law}" for law in laws)], body)


def ppo_search() -> str:
    """Return the runs of the search of PPO's settings, best first."""
    found = rows("leaders/ppo_search.csv")
    found.sort(key=lambda row: -float(row["mean"]))
    body = []
    for row in found:
        known = row["learning_rate"] != ""
        body.append(
            [
                f"run {row['run']}" if known else row["run"],
                f"{float(row['learning_rate']):.1e}" if known else "",
                row["log_std_init"],
                {"True": "yes", "False": "no"}.get(row["use_sde"], ""),
                row["control_hz"],
                f"{float(row['mean']):.3f}",
            ]
        )
    header = ["", "learning rate", "`log_std_init`", "gSDE", "decisions per second", "signed order"]
    return markdown(header, body)


TRAINING_TABLES = {
    "first-training": first_training,
    "ppo-comparison": ppo_comparison,
    "ppo-search": ppo_search,
    "signals": signals,
    "lean-signals": lean_signals,
    "trained-500-boats": partial(trained, "500-boats"),
    "trained-table-1": partial(trained, "table-1"),
}
"""How each table is made."""
