"""What the pages say in numbers about the trainings of `make pretrained`."""

from committed_data import Row, one

NUMERALS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")
SUMMARIES = {"500": "algorithms-500", "1 101": "algorithms"}
"""Files of the means over seeds, by the flock-hours of each."""


def _reached(row: Row) -> tuple[str, str]:
    names = ("signed_order", "lowest", "highest", "gain", "gain_low", "gain_high")
    mean, low, high, gain, least, most = (f"{float(row[name]):.3f}" for name in names)
    return f"{mean} in the mean ({low} to {high})", f"{gain} ({least} to {most})"


def pretrained() -> str:
    """Return what the trainings in `wide` reached."""
    few, many = (one(f"training/pretrained/{file}.csv") for file in SUMMARIES.values())
    (few_reached, few_gain), (many_reached, many_gain) = _reached(few), _reached(many)
    seeds = NUMERALS[int(many["seeds"])]
    return (
        f"**After 1 101 flock-hours, {seeds} seeds reach {many_reached}: {many_gain} more than the "
        f"tuned law.** On the way, after 500, they reach {few_reached}: {few_gain} more."
    )
