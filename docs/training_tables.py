"""The tables of the pages about training: the easy environment, settings, signals of rewards."""

from committed_data import interval, markdown, one, rows

SIGNALS = {
    "rudders in `wide`": ("results/signals.csv", "wide"),
    "rudders in `narrow`": ("results/signals.csv", "narrow"),
    "leans in `wide`": ("results/signals_ppo_weights.csv", "wide"),
}


def signals() -> str:
    """Return z per million samples of each reward, for a horizon of 30 s."""
    body = []
    for reward in ("leader_velocity", "contact_push", "signed_order"):
        cells = [f"`{reward}`"]
        for file, pool in SIGNALS.values():
            wanted = {"pool": pool, "reward": reward, "horizon_s": "30.0"}
            if any(row["reward"] == reward for row in rows(file)):
                row = one(file, **wanted)
                cells.append(f"{float(row['z_per_million']):+.1f} ± {float(row['error']):.1f}")
            else:
                cells.append("")
        body.append(cells)
    return markdown(["reward", *SIGNALS], body)


def settings() -> str:
    """Return how trainings with different settings compare with the tuned law."""
    body = [
        [
            row["change"],
            f"`{row['pool']}`",
            row["seeds"],
            row["flock_hours"],
            interval(row, "difference", "low", "high", "+.3f"),
        ]
        for row in rows("training/settings.csv")
    ]
    return markdown(["setting", "pool", "seeds", "flock-hours", "minus the tuned law"], body)


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


TRAINING_TABLES = {"easy": easy, "signals": signals, "training-settings": settings}
"""How each table is made."""
