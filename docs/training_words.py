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
