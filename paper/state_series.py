"""A run as a series over its control cycles: order, states, and how order comes."""

import math
from typing import Any

import numpy as np
import pandas as pd
from study import Row

import flockenv
from flockenv.statistics.structure import structure_series

_STAYS = 3
"""Cycles in a row for which a series stays above a level that it has reached."""


def cycles(run: flockenv.Recording) -> pd.DataFrame:
    """Return means over each analysis window, and its most frequent state."""
    used = np.flatnonzero(run.in_analysis_window)
    clusters = np.zeros(len(run.time_s))
    clusters[used] = structure_series("largest_cluster", run.parameters, run.pose[used])
    states = run.order.states(run.parameters.speed_cm_s, clusters)[used]
    window = np.cumsum(np.diff(run.time_s[used], prepend=-10.0) > 1.0)
    order = run.order
    frames = pd.DataFrame(
        {
            "window": window,
            "time_s": run.time_s[used],
            "psi_o": order.psi_o[used],
            "psi_v": order.psi_v[used],
            "m": order.rotation()[used],
            "outward": order.outward()[used],
        }
    )
    found = frames.groupby("window").mean()
    names = pd.Series([s.partition(" ")[0] for s in states]).groupby(window).agg(_most_frequent)
    return found.assign(state=names.to_numpy())


def _most_frequent(names: Any) -> str:
    return str(names.value_counts().index[0])


def onset(found: pd.DataFrame) -> Row:
    """Return how much earlier Ψ_o is halfway to order than Ψ_v, and how long each rises (s).

    Of runs whose second half rotates (mean |m| of at least 0.5). A series is halfway when it has
    come half of the way from its first two cycles to its mean over the second half and stays
    above for three cycles; it rises from a tenth to nine tenths.
    """
    late = found[len(found) // 2 :]
    none = {"lead_s": math.nan, "rise_o_s": math.nan, "rise_v_s": math.nan}
    if not abs(late["m"]).mean() >= 0.5:
        return none
    reached = {}
    for name in ("psi_o", "psi_v"):
        start, end = found[name][:2].mean(), late[name].mean()
        way = ((found[name] - start) / (end - start)).to_numpy()
        held = np.lib.stride_tricks.sliding_window_view(way, _STAYS).min(axis=1)
        if held.max() < 0.9:
            return none
        reached[name] = [found["time_s"].iloc[int((held >= x).argmax())] for x in (0.1, 0.5, 0.9)]
    o, v = reached["psi_o"], reached["psi_v"]
    return {"lead_s": v[1] - o[1], "rise_o_s": o[2] - o[0], "rise_v_s": v[2] - v[0]}
