"""Draw order against the number of leaders, from committed means: `make tables`."""

import pandas as pd
from committed_data import DOCS

from flockenv.comparison.figure import leader_curve

FOLDER = DOCS / "leaders"


def main() -> None:
    """Draw both pools' curves."""
    means = pd.read_csv(FOLDER / "means.csv")
    for pool, bw_s in (("wide", 0.31), ("narrow", 0.45)):
        case = f"{pool}-bw-{bw_s:g}"
        own = means[means["case"] == case]
        episodes = own["runs"].max()
        title = f"27 boats, pool {pool}, bw = {bw_s:g} s, target cw, {episodes} episodes per point"
        leader_curve(own, FOLDER / f"curve-{pool}.png", titles={case: title})


if __name__ == "__main__":
    main()
