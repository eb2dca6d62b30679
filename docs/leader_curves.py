"""Draw order against the number of leaders, from committed means: `make tables`.

The means of docs/leaders/means.csv are over equally many episodes for each number of leaders, so
that a line through them is the line through the episodes. The F-tests of the episodes are in
docs/leaders/lines.csv.
"""

import numpy as np
import pandas as pd
from committed_data import DOCS

from flockenv.comparison.figure import leader_curve
from flockenv.statistics import Line

FOLDER = DOCS / "leaders"
BW_S = {"wide": 0.31, "narrow": 0.45}


def main() -> None:
    """Draw both pools' curves."""
    means, tests = (pd.read_csv(FOLDER / f"{name}.csv") for name in ("means", "lines"))
    for pool, bw_s in BW_S.items():
        own = means[means["comparison"] == pool]
        lines = {
            (row["policy"], row["quantity"]): line(own, row)
            for row in tests[tests["pool"] == pool].to_dict("records")
        }
        title = f"27 boats, pool {pool}, bw = {bw_s:g} s, target cw, 512 episodes per point"
        leader_curve(None, own, lines, title, FOLDER / f"curve-{pool}.png")


def line(means: pd.DataFrame, test: dict[str, object]) -> Line:
    """Return the line through a policy's means, with the F-test of its episodes."""
    own = means[means["policy"] == test["policy"]]
    slope, intercept = np.polyfit(own["leaders"], own[test["quantity"]], 1)
    return Line(float(slope), float(intercept), test["f"], test["p"], int(own["runs"].sum()))


if __name__ == "__main__":
    main()
