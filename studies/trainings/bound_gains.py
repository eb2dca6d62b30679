"""Bound the mean gains of trainings whose scores in each flock were not kept.

    python -m studies.trainings.bound_gains    # rewrites the tables algorithms.csv

All trainings met the same flocks, so that the interval of a mean gain holds the luck of the seeds
and that of the flocks. `studies.trainings.judge_trainings` draws both from the scores in each
flock. Of the trainings in the folder results (version 5) neither scores nor policies were kept,
but for one policy. Their intervals are bounds from what `evaluation.csv` has: half widths over the
seeds' means (Student's) and over the flocks (that of one training, in the mean) are added as
squares, as if all luck of the flocks were shared. The true interval is narrower.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from flockenv.statistics import student_interval
from studies.store import write
from studies.study import run

RESULTS = Path(__file__).parent / "results"
BOUND = "bound"
"""What the column ``interval`` says of these; one that is drawn from scores is "drawn"."""


def bound(gains: pd.DataFrame) -> tuple[float, float, float]:
    """Return the mean gain of trainings with a bound of its interval.

    A row per training, with its gain and the ends of its interval over the flocks.
    """
    mean, low, high = student_interval(gains["gain"].to_numpy(float))
    flocks = (gains["gain_high"] - gains["gain_low"]).mean() / 2
    half = float(np.hypot((high - low) / 2, flocks))
    return mean, mean - half, mean + half


def bounded(means: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Return a table of algorithms with the bounds that a table of trainings gives."""
    algorithm = found["policy"].str.rsplit(n=1).str[0]
    own = {name: bound(found[algorithm == name]) for name in means["algorithm"]}
    ends = {f"gain_{end}": [own[name][place] for name in own] for place, end in _ENDS.items()}
    return means.assign(**ends, interval=BOUND)


_ENDS = {1: "low", 2: "high"}


def main() -> None:
    for path in sorted(RESULTS.glob("*/algorithms*.csv")):
        found = pd.read_csv(path.with_name(path.name.replace("algorithms", "evaluation")))
        table = bounded(pd.read_csv(path), found)
        write(path, table.to_csv(index=False, float_format="%.4f", lineterminator="\n").encode())
        print(table.round(3).to_string(index=False))


if __name__ == "__main__":
    run(main)
