"""The tables of the pages about training: the easy environment, seeds, signals of rewards."""

from committed_data import interval, markdown, one, rows

ALGORITHMS = {
    "train_leaders": "PPO (the example)",
    "trpo": "TRPO",
    "evolution": "evolution strategy",
}
"""Algorithms by the folders of their trainings."""
SIGNALS = (("rudder", "wide"), ("rudder", "narrow"), ("lean", "wide"))


def signals() -> str:
    """Return z per million samples of each reward, for a horizon of 30 s."""
    body = []
    for reward in ("leader_velocity", "contact_push", "contact_alignment", "signed_order"):
        cells = [f"`{reward}`"]
        for mode, pool in SIGNALS:
            row = one("results/signals.csv", pool=pool, action_mode=mode, reward=reward)
            cells.append(f"{float(row['z_per_million']):+.1f} ± {float(row['error']):.1f}")
        body.append(cells)
    return markdown(["reward", *(f"{mode}s in `{pool}`" for mode, pool in SIGNALS)], body)


def seeds() -> str:
    """Return what each training by the example reached, and the laws in its flocks."""
    body = []
    for row in rows("training/wide/evaluation.csv"):
        gain = interval(row, "gain", "gain_low", "gain_high", "+.3f") if row["gain"] else ""
        body.append([row["policy"], interval(row, "signed_order", "low", "high"), gain])
    return markdown(["policy", "signed order", "minus the tuned law"], body)


def algorithms() -> str:
    """Return what each algorithm reached in the mean of its seeds."""
    body = []
    for row in rows("training/algorithms/algorithms.csv"):
        mean, *ends = (f"{float(row[name]):.3f}" for name in ("signed_order", "lowest", "highest"))
        gain = interval(row, "gain", "gain_low", "gain_high", "+.3f")
        name = ALGORITHMS[row["algorithm"]]
        body.append([name, row["seeds"], mean, " to ".join(ends), gain])
    return markdown(
        ["algorithm", "seeds", "signed order", "of single seeds", "minus the tuned law"], body
    )


def nothing() -> str:
    """Return what leaders from nothing reached, and the laws in their flocks."""
    body = []
    for pool, seeds in {"wide": (0, 1, 2), "narrow": (2, 3, 4)}.items():
        ends = [rows(f"training/from_nothing/{pool}_{n}/curve.csv", stage="end") for n in seeds]
        for law in ends[0][:-1]:
            body.append(
                [f"`{pool}`", law["policy"], "", interval(law, "signed_order", "low", "high")]
            )
        for seed, (*_, end) in zip(seeds, ends, strict=True):
            minutes = f"{float(end['cpu_s']) / 60:.1f}"
            order = interval(end, "signed_order", "low", "high")
            body.append([f"`{pool}`", f"{end['policy']}, seed {seed}", minutes, order])
    return markdown(["pool", "policy", "minutes of one core", "signed order"], body)


def easy() -> str:
    """Return what each training in the easy environment reached, and the laws in its flocks."""
    body = []
    for row in rows("easy/curve.csv"):
        reached = interval(row, "signed_order", "low", "high")
        if not row["seed"]:
            body.append([row["policy"], "", reached, ""])
        elif row["policy"] == "PPO minus paper's law":
            (*_, last) = rows("easy/curve.csv", policy="PPO", seed=row["seed"])
            order = interval(last, "signed_order", "low", "high")
            gain = interval(row, "signed_order", "low", "high", "+.3f")
            body.append([f"PPO, seed {row['seed']}", f"{float(row['cpu_s']):.0f}", order, gain])
    return markdown(["policy", "processor time (s)", "signed order", "minus paper's law"], body)


TRAINING_TABLES = {
    "algorithms": algorithms,
    "easy": easy,
    "from-nothing": nothing,
    "signals": signals,
    "training-seeds": seeds,
}
"""How each table is made."""
