"""Quantities that pages quote and that are computed from rows of the tables of speed and error."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

OURS = {"engine": "flockenv", "setting": "leapfrog / block-pivoting / 1e-4 cm", "dt_s": 0.01}
OURS_LINEAR = OURS | {"setting": "leapfrog / block-pivoting / linear"}
BOX2D = {"engine": "Box2D (f32)", "setting": "4 substeps / unit 10 cm", "dt_s": 0.01}
LEADERS = 4
"""Leaders of each flock whose batch is timed."""

Values = str | Callable[[pd.DataFrame], pd.Series]
"""A column, or a function that computes values from rows."""


def two_digits(value: float) -> float:
    """Round to two significant digits."""
    return float(f"{value:.2g}")


def least(values: Values) -> Callable[[pd.DataFrame], float]:
    """Return a function for the least of these values."""
    return lambda rows: (rows[values] if isinstance(values, str) else values(rows)).min()


def most(values: Values) -> Callable[[pd.DataFrame], float]:
    """Return a function for the largest of these values."""
    return lambda rows: (rows[values] if isinstance(values, str) else values(rows)).max()


def matching(rows: pd.DataFrame, row: dict[str, Any]) -> pd.DataFrame:
    """Return the rows with these values."""
    return rows[(rows[list(row)] == pd.Series(row)).all(axis=1)]


def million_agent_steps(rows: pd.DataFrame) -> float:
    """Return how many million decisions of leaders a batch makes per second."""
    return LEADERS * rows["median"].iloc[0] / 1e6


def samples(rows: pd.DataFrame) -> float:
    """Return the samples per second, to two digits."""
    return two_digits(rows["samples/s"].item())


def megabytes(rows: pd.DataFrame) -> float:
    """Return the memory in MB."""
    return rows["bytes"].item() / 1e6


def us_per_step(rows: pd.DataFrame, engine: dict[str, Any]) -> float:
    """Return the time of an engine's step in µs."""
    return matching(rows, engine)["us_per_step"].item()


def box2d(rows: pd.DataFrame) -> float:
    """Return the time of Box2D's step over ours."""
    return us_per_step(rows, BOX2D) / us_per_step(rows, OURS)


def box2d_over_linear(rows: pd.DataFrame) -> float:
    """Return the time of Box2D's step over ours with linear gaps."""
    return us_per_step(rows, BOX2D) / us_per_step(rows, OURS_LINEAR)


def time_spread(rows: pd.DataFrame) -> float:
    """Return the interquartile range of the times of a step in % of their median."""
    return (100 * (rows["us_q3"] - rows["us_q1"]) / rows["us_per_step"]).item()


def time_per_boat(rows: pd.DataFrame) -> float:
    """Return the time per boat of a step of 1000 boats over that of 27."""
    times = rows.set_index("n")["us_per_step"]
    return times[1000] / 1000 / (times[27] / 27)


def overlap_over_ours(engine: dict[str, Any]) -> Callable[[pd.DataFrame], float]:
    """Return a function for the ratio of another engine's mean overlap to ours, to two digits."""

    def ratio(rows: pd.DataFrame) -> float:
        theirs, ours = (matching(rows, row)["overlap_mean_cm"].mean() for row in (engine, OURS))
        return two_digits(theirs / ours)

    return ratio


def contact_exponents(rows: pd.DataFrame) -> pd.Series:
    """Return the exponents of the step with which errors in contact fall, by scheme and scene."""
    exponents = rows[rows["scheme"].isin(["leapfrog", "moreau"])].set_index("scheme")
    return exponents[["0.5 s of the jam", "0.5 s of the cycle"]].stack()


def impact_ratios(rows: pd.DataFrame) -> pd.Series:
    """Return the ratio of the error of `leapfrog` in an impact to that of `moreau`, by step."""
    by_scheme = rows.set_index("scheme")
    return by_scheme.loc["leapfrog / linear"] / by_scheme.loc["moreau / linear"]


def largest_shift(rows: pd.DataFrame) -> float:
    """Return the largest end of any interval of a shift of the noise at which order is lost."""
    shifts = rows[rows["quantity"].str.startswith("noise of the same")]
    return shifts[["low", "high"]].abs().max(axis=None)


def cost_of_fixed_steps(
    fixed: pd.DataFrame, error: str, cost: str, errors: pd.Series
) -> np.ndarray:
    """Return the cost of fixed steps with these errors, interpolated on logarithmic scales."""
    ordered = fixed.sort_values(error)
    log_error, log_cost = np.log(ordered[[error, cost]].to_numpy().T)
    return np.exp(np.interp(np.log(errors), log_error, log_cost))


def substep_ratios(rows: pd.DataFrame) -> pd.Series:
    """Return the ratio of substeps, controlled over fixed at the same error, by setting."""
    fixed, controlled = (rows[rows["step"] == step] for step in ("fixed", "controlled"))
    # A setting with a smaller error than every fixed step is left out.
    errors = fixed["error_cm"]
    controlled = controlled[controlled["error_cm"].between(errors.min(), errors.max())]
    return controlled["substeps"] / cost_of_fixed_steps(
        fixed, "error_cm", "substeps", controlled["error_cm"]
    )


def substep_ratios_in_flocks(rows: pd.DataFrame) -> pd.Series:
    """Return the same ratios in the scenes with many boats."""
    scenes = rows[rows["scene"] != "impact"].groupby("scene")
    return pd.concat([substep_ratios(scene_rows) for _, scene_rows in scenes])


def time_ratios(column: str) -> Callable[[pd.DataFrame], pd.Series]:
    """Return a function that divides times of controlled by fixed steps of equal error."""

    def of_scene(rows: pd.DataFrame) -> pd.Series:
        is_controlled = rows["setting"].str.startswith("controlled")
        controlled, fixed = rows[is_controlled], rows[~is_controlled]
        errors = fixed["error_median_cm"]
        assert controlled["error_median_cm"].between(errors.min(), errors.max()).all()
        return controlled[column] / cost_of_fixed_steps(
            fixed, "error_median_cm", "us_per_s", controlled["error_median_cm"]
        )

    def ratios(rows: pd.DataFrame) -> pd.Series:
        scenes = rows[rows["engine"] == "flockenv"].groupby("scene")
        return pd.concat([of_scene(scene_rows) for _, scene_rows in scenes])

    return ratios


def speed_over_ours(environment: str) -> Callable[[pd.DataFrame], float]:
    """Return a function for the best speed of another environment over our best one."""

    def ratio(rows: pd.DataFrame) -> float:
        best = rows.groupby("environment")["steps per second of one core"].max()
        return best[environment] / best["flockenv, hulls with exact contacts"]

    return ratio


def time_over_ours(environment: str) -> Callable[[pd.DataFrame], float]:
    """Return a function for the least time of a step of another environment over our least one."""
    speed_ratio = speed_over_ours(environment)
    return lambda rows: 1 / speed_ratio(rows)
