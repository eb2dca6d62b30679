"""The tables of the pages about training: the easy environment, seeds, signals of rewards."""

from collections.abc import Mapping

from committed_data import DOCS, interval, markdown, one, rows

from flockenv.policies import load

ALGORITHMS = {
    "train_leaders": "PPO (the example)",
    "trpo": "TRPO",
    "evolution": "evolution strategy",
}
"""Algorithms by the folders of their trainings."""
BASELINES = {"ppo": "PPO", "evolution": "evolution strategy", "ippo": "IPPO", "mappo": "MAPPO"}
"""The suite's baselines by the names of their rows."""
ENTRIES = DOCS.parent / "baselines" / "suite"
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


def made_by(entry: str) -> Mapping[str, str]:
    """Return what made a policy of the suite; a LookupError refuses one that does not say it."""
    (file,) = ENTRIES.glob(f"*/{entry}.*")
    made = load(file).provenance
    missing = {"command", "flock_hours", "samples"} - made.keys()
    if missing:
        raise LookupError(f"{file.name} does not say its {', '.join(sorted(missing))}")
    return made


def baselines() -> str:
    """Return the scores of the suite's baselines, means over three seeds, and their budgets."""
    header, body = [], []
    for algorithm, called in BASELINES.items():
        for hours in (100, 1000):
            names = [f"{algorithm}-{hours}-{seed}" for seed in range(3)]
            made, *_ = map(made_by, names)
            seeds = [rows("suite/baselines.csv", policy=name) for name in names]
            header = [row["task"] for row in seeds[0][:-1]]
            scores = [[float(row["score"]) for row in own[:-1]] for own in seeds]
            means = [f"{sum(own) / 3:+.3f}" for own in zip(*scores, strict=True)]
            lowest, *_, highest = sorted(own[-1] for own in scores)
            budget = [f"{float(made['flock_hours']):.0f}", f"{int(made['samples']):,}"]
            ends = f"{means[-1]} ({lowest:+.3f} to {highest:+.3f})"
            body.append([called, *budget, *means[:-1], ends])
    return markdown(["algorithm", "flock-hours", "environment steps", *header], body)


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
    "suite-baselines": baselines,
    "training-seeds": seeds,
}
"""How each table is made."""
