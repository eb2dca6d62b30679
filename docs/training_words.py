"""What the pages say in numbers about trainings by the example."""

from committed_data import one, rows

NUMERALS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")


def example() -> str:
    """Return what the longest trainings by the example reached."""
    found = rows("training/wide/evaluation.csv")
    trained = [float(row["signed_order"]) for row in found if row["policy"].startswith("seed")]
    law = float(one("training/wide/evaluation.csv", policy="tuned law")["signed_order"])
    return (
        f"**After 2 000 flock-hours, {NUMERALS[len(trained)]} seeds reach {min(trained):.3f} to "
        f"{max(trained):.3f}, and the tuned law {law:.3f}.**"
    )


def pretrained() -> str:
    """Return what the trainings of `make pretrained` in `wide` reached."""
    row = one("training/pretrained/algorithms.csv")
    mean, low, high, *gain = (
        float(row[name])
        for name in ("signed_order", "lowest", "highest", "gain", "gain_low", "gain_high")
    )
    return (
        f"The {NUMERALS[int(row['seeds'])]} seeds of `make pretrained`, which train with one to "
        f"four leaders for 1 101 flock-hours each, reach {mean:.3f} in the mean ({low:.3f} to "
        f"{high:.3f}) with three leaders: {gain[0]:.3f} ({gain[1]:.3f} to {gain[2]:.3f}) more "
        "than the tuned law."
    )
