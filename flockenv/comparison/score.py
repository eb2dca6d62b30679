"""The score of a policy: its mean signed order, and its gain on another policy's."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flockenv._io.arguments import by_name, series
from flockenv._io.extras import require
from flockenv.errors import refuse_unknown
from flockenv.statistics import mean_interval, paired_difference

if TYPE_CHECKING:
    import pandas as pd

SCORE = ("flocks", "signed_order", "low", "high", "gain", "gain_low", "gain_high")
"""The columns of a score: the number of flocks, their mean signed order with the ends of its
interval, and the gain on the reference with the ends of its interval."""


def score_policies(
    orders: Mapping[str, Iterable[float]], reference: str | None = None
) -> "pd.DataFrame":
    """Score policies by the signed order of the flocks that each of them led.

    Parameters
    ----------
    orders
        The signed order of each flock by the policy's name, as `run_episodes` returns it.
    reference
        Name of the policy that the others are compared with, flock by flock: all policies led the
        same flocks, in the same order.

    Returns
    -------
    pandas.DataFrame
        One row per policy, in the order given: ``policy`` and the columns `SCORE`. The gains are
        NaN for the reference itself and without one, and intervals for a single flock.

    Raises
    ------
    ParameterError
        For a reference that is not among the policies, for policies without flocks, and for a
        policy whose number of flocks differs from the reference's.
    """
    pandas = require("pandas", "plot")
    values = {
        name: series(own, f"orders[{name!r}]") for name, own in by_name(orders, "orders").items()
    }
    if reference is not None:
        refuse_unknown([reference], values, "policy of these")
    rows = []
    for name, own in values.items():
        gain = (np.nan,) * 3
        if reference is not None and name != reference:
            found = paired_difference(own, values[reference])
            gain = (found.mean, found.low, found.high)
        scored = (len(own), *mean_interval(own), *gain)
        rows.append({"policy": name, **dict(zip(SCORE, scored, strict=True))})
    table: pd.DataFrame = pandas.DataFrame(rows, columns=["policy", *SCORE])
    return table
