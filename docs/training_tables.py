"""The tables of docs/train.md: what settings of trainings gave, and signals of rewards."""

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


TRAINING_TABLES = {"signals": signals, "training-settings": settings}
"""How each table is made."""
