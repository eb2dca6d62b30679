"""Measure what laws reach in the levels of suite v3: the scale of its scores.

    python -m studies.levels.laws        # a minute or two of one core

`straight ahead` has the score 0 and the damped law 1. The paper's law and, in `wide`, the learned
leaders stand beside them; all have the 512 flocks of the suite. OUT/laws.csv has a row for each.
"""

import argparse
from pathlib import Path

import pandas as pd

from flockenv.comparison import score_policies
from flockenv.comparison.levels import FLOCKS, LEVELS, NO_STEERING, REFERENCE
from studies.store import resumed, write_table
from studies.study import run

LEARNED, LAWS = "learned", (REFERENCE, "paper's law", NO_STEERING)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flocks", type=int, default=FLOCKS)
    parser.add_argument("--out", type=Path, default=Path("studies/levels/results/laws.csv"))
    options = parser.parse_args(arguments)
    table = resumed(options.out)
    for name, level in LEVELS.items():
        if len(table) and name in set(table["level"]):
            continue
        laws = (LEARNED, *LAWS) if level.parameters.pool == "wide" else LAWS
        orders = {law: level.run(law, options.flocks)["signed_order"] for law in laws}
        table = pd.concat([table, score_policies(orders, REFERENCE).assign(level=name)])
        write_table(options.out, table, "%.4f")
        print(table[table["level"] == name].round(3).to_string(index=False), flush=True)


if __name__ == "__main__":
    run(main)
