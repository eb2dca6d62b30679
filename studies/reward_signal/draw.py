"""Draw how clearly samples of each reward show the way to a better policy."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from studies.plots import drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
SIGNALS = RESULTS / "signals.csv"


def signals(figure: Figure) -> None:
    """Draw how clearly samples of each reward show the way to a better policy."""
    names = {
        "leader_velocity": "leader's velocity",
        "contact_push": "push of its contacts",
        "contact_alignment": "turning by contacts",
        "signed_order": "signed order",
    }
    cases = (("rudder", "wide"), ("rudder", "narrow"), ("lean", "wide"))
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (mode, pool) in zip(panels, cases, strict=True):
        found = {}
        for name, words in names.items():
            (row,) = rows(SIGNALS, pool=pool, action_mode=mode, reward=name)
            z, error = float(row["z_per_million"]), float(row["error"])
            found[words] = (z, z - 1.96 * error, z + 1.96 * error)
        listed(axes, found, dict.fromkeys(found, "0.15"), 0.0)
        axes.set(title=f"{mode}s in {pool}", xlabel="z for a million samples")


PLOTS = {
    "signals": Plot([SIGNALS], signals, (8.4, 2.8)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
