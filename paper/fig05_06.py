"""Figures 5 and 6: order parameters over time at bw = 1.4 and 1.9 s, of the median run."""

import numpy as np
import pandas as pd
from state_series import cycles
from states import STUDY
from study import COLORS, Options, main, picture, simulated

LEVELS_S = {"fig05": 1.4, "fig06": 1.9}


def median_run(table: pd.DataFrame, bw_s: float) -> pd.Series:
    """Return the row of the run whose mean Ψ_o is the median of its level."""
    runs = table[np.isclose(table["bw_s"], bw_s)].sort_values("psi_o")
    return runs.iloc[len(runs) // 2]


def script(options: Options) -> None:
    """Draw the median run of each level, as means over each analysis window."""
    table = STUDY.results(options)
    for name, bw_s in LEVELS_S.items():
        row = median_run(table, bw_s).to_dict()
        row["n_leaders"] = int(row["n_leaders"])
        found = cycles(simulated(row, sample_hz=5.0))
        minutes = found["time_s"] / 60
        with picture(options, name, height_cm=5.0) as figure:
            left, middle, right = figure.subplots(1, 3, sharex=True)
            left.plot(minutes, found["psi_o"], color=COLORS[0])
            left.set(ylabel="Ψ_o", ylim=(0, 1))
            middle.plot(minutes, np.arctan2(found["m"], found["outward"]), ".", color=COLORS[1])
            middle.set(ylabel="φ_o", yticks=[-np.pi / 2, 0, np.pi / 2], ylim=(-3.2, 3.2))
            middle.set_yticklabels(["−π/2", "0", "π/2"])
            right.plot(minutes, found["psi_v"], color=COLORS[2])
            right.set(ylabel="Ψ_v (cm/s)", ylim=(0, None))
            for axes in (left, middle, right):
                axes.set_xlabel("time (min)")
            runs = int(np.isclose(table["bw_s"], bw_s).sum())
            middle.set_title(f"bw = {bw_s:g} s, 27 boats, no leaders: the median of {runs} runs")


if __name__ == "__main__":
    main(script)
