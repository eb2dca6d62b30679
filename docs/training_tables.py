"""The tables of docs/train.md: what trainings, their searches and signals of rewards gave."""

from committed_data import difference, markdown, one, order, rows

MEANS = "leaders/means.csv"
DIFFERENCES = "leaders/differences.csv"
POOLS = ("500-boats", "table-1")


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
    """Return what `flockenv signal` measured: z per million samples of each reward and horizon."""
    file = "results/signals.csv"
    found = rows(file)
    horizons = list(dict.fromkeys(row["horizon_s"] for row in found))
    body = []
    for pool, reward_name in dict.fromkeys((row["pool"], row["reward"]) for row in found):
        each = (one(file, pool=pool, reward=reward_name, horizon_s=horizon) for horizon in horizons)
        cells = (f"{float(row['z_per_million']):+.1f} ± {float(row['error']):.1f}" for row in each)
        body.append([f"`{pool}`", f"`{reward_name}`", *cells])
    titles = (f"horizon {float(horizon):g} s" for horizon in horizons)
    return markdown(["pool", "reward", *titles], body)


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
