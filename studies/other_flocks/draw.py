"""Draw what learned leaders add to the tuned law in flocks unlike their training."""

import re
from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, Row, listed, rows
from studies.plots import drawing, interval
from studies.study import main

RESULTS = Path(__file__).parent / "results"
BEYOND = RESULTS / "beyond.csv"


def beyond(figure: Figure) -> None:
    """Draw what learned leaders add to the tuned law in other flocks than those of the training."""
    axes = figure.subplots()
    found = {_in_words(row): interval(row, "gain", "gain_low", "gain_high") for row in rows(BEYOND)}
    listed(axes, found, dict.fromkeys(found, "0.15"), 0.0)
    axes.set(xlabel="learned minus tuned law", xticks=(-0.05, 0.0, 0.05, 0.1))


def _in_words(row: Row) -> str:
    what, value = row["what"], row["value"]
    words = {
        "bw_s": f"bw = {value} s",
        "c4": f"c4 = {value} rad/s$^{{1.5}}$",
        "n_boats": f"{value} boats",
        "n_leaders": re.sub(r"^\d+", r"\g<0> leaders", value) if value != "1" else "1 leader",
        "scheme": f"scheme of the {value}",
    }
    return words.get(what, " ".join({what: 0, value: 0}))


PLOTS = {
    "beyond": Plot([BEYOND], beyond, (6.8, 6.2)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
