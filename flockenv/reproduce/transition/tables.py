"""The tables of `transition-order`."""

import math

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.reproduce.claim import number
from flockenv.reproduce.transition.design import FINE_DT_S
from flockenv.reproduce.transition.measured import (
    C_V_EDGES,
    CENTERS,
    M_EDGES,
    STATES,
    Jams,
    Measured,
)
from flockenv.statistics.intervals import interval, student_interval

__all__ = ["tables"]

_EARLY_MIN = 10.0
"""The table of first jams counts those before this time apart."""


def tables(measured: Measured) -> dict[str, pd.DataFrame]:
    """Return all tables by name: of jams, of whole flocks, and of loops."""
    return {
        "jams": _jams(measured),
        "nucleation": _nucleation(measured),
        "dissolution": _dissolution(measured),
        "substeps": _substeps(measured),
        "transition": _points(measured),
        "loops": _loops(measured),
        "histograms": _histograms(measured),
        "lifetimes": _lifetimes(measured),
    }


def _jams(measured: Measured) -> pd.DataFrame:
    rows: list[dict[str, object]] = []
    for (growth, density, start), stationary in measured.stationary.items():
        rows.append(
            {
                "way": growth.way,
                "density": density,
                "boats": growth.n_boats,
                "start": start,
                **_jam_columns(stationary.jams),
            }
        )
    return _by_density(rows)


def _jam_columns(jams: Jams) -> dict[str, str]:
    named = {"in jams": jams.share, "mean size": jams.mean_size, "largest": jams.largest}
    return {name: _with_error(values) for name, values in named.items()}


def _with_error(values: NDArray[np.float64]) -> str:
    error = values.std(ddof=1) / len(values) ** 0.5
    return f"{number(values.mean())} ± {error:.2g}"


def _nucleation(measured: Measured) -> pd.DataFrame:
    """When flocks that started rotating have their first jam."""
    rows: list[dict[str, object]] = []
    for (growth, density, start), stationary in measured.stationary.items():
        if start != "rotating":
            continue
        jams = stationary.jams
        first_min = jams.first_s[np.isfinite(jams.first_s)] / 60.0
        early = int((first_min < _EARLY_MIN).sum())
        rows.append(
            {
                "way": growth.way,
                "density": density,
                "boats": growth.n_boats,
                "runs": len(jams.first_s),
                f"with a jam before {_EARLY_MIN:g} min": early,
                "with one later": len(first_min) - early,
                "first jam, min": _median(first_min),
            }
        )
    return _by_density(rows)


def _dissolution(measured: Measured) -> pd.DataFrame:
    """When the jam of flocks that started in one has lost half of its boats."""
    rows: list[dict[str, object]] = []
    for (growth, density, start), stationary in measured.stationary.items():
        if start != "one-jam":
            continue
        after = stationary.jams.dissolved_s
        after_min = after[np.isfinite(after)] / 60.0
        row = {"way": growth.way, "density": density, "boats": growth.n_boats, "runs": len(after)}
        rows.append(row | {"dissolved": len(after_min), "after, min": _median(after_min)})
    return _by_density(rows)


def _median(values: NDArray[np.float64]) -> str:
    return number(float(np.median(values)) if len(values) else math.nan)


def _by_density(rows: list[dict[str, object]]) -> pd.DataFrame:
    return pd.DataFrame(rows).sort_values(
        ["way", "density"], kind="stable", ascending=[False, True]
    )


def _substeps(measured: Measured) -> pd.DataFrame:
    rows = []
    for (growth, density, start), fine in measured.fine.items():
        point = {"way": growth.way, "density": density, "boats": growth.n_boats, "start": start}
        usual = measured.stationary[growth, density, start].jams
        dt_s = growth.parameters(density).dt_s
        for step_s, jams in ((FINE_DT_S, fine), (dt_s, usual)):
            rows.append(point | {"substep, s": f"{step_s:g}"} | _jam_columns(jams))
    return pd.DataFrame(rows)


def _points(measured: Measured) -> pd.DataFrame:
    rows = []
    for (growth, density, start), stationary in measured.stationary.items():
        row: dict[str, object] = {"way": growth.way, "n_boats": growth.n_boats}
        row |= {"density": density, "start": start}
        for name, ends in (
            ("outward", student_interval(stationary.outward)),
            ("binder_m", interval(stationary.binder_m)),
            ("binder_c_v", interval(stationary.binder_c_v)),
        ):
            row |= dict(zip((name, f"{name}_low", f"{name}_high"), ends, strict=True))
        rows.append(row)
    return pd.DataFrame(rows)


def _loops(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, kind), loop in measured.loops.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "loop": kind}
        value, low, high = student_interval(loop.openings)
        columns = {"position": CENTERS, "there": loop.there, "back": loop.back}
        ends = {"opening": value, "opening_low": low, "opening_high": high}
        tables.append(pd.DataFrame({**keys, **columns, **ends}))
    return pd.concat(tables)


def _lifetimes(measured: Measured) -> pd.DataFrame:
    rows = []
    for growth in measured.design.growths():
        found = measured.lifetime(growth)
        value, low, high = (math.exp(end) / 60 for end in interval(found.log_s))
        row: dict[str, object] = {"way": growth.way, "boats": growth.n_boats}
        row |= {"density": found.density, "lifetime, min": number(value)}
        row["interval"] = f"{number(low)} to {number(high)}"
        for state, time_s, changes in zip(
            STATES, found.dwell.time_s, found.dwell.changes.sum(axis=1), strict=True
        ):
            row |= {f"{state}, min": number(time_s / 60), f"changes from {state}": int(changes)}
        rows.append(row)
    return pd.DataFrame(rows)


def _histograms(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, density, start), stationary in measured.stationary.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "density": density, "start": start}
        for name, edges in (("m", M_EDGES), ("c_v", C_V_EDGES)):
            bins = {"bin_low": edges[:-1], "bin_high": edges[1:]}
            heights = {"probability_density": getattr(stationary, f"{name}_density")}
            tables.append(pd.DataFrame({**keys, "quantity": name, **bins, **heights}))
    return pd.concat(tables)
