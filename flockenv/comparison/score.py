"""The score of a policy: its mean signed order, and its gain over a reference policy."""

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
interval, and the gain over the reference with the ends of its interval."""


def score_policies(
    orders: Mapping[str, Iterable[float]], reference: str | None = None
) -> "pd.DataFrame":
    """Score policies by the signed order of the flocks that each of them led.

    Parameters
    ----------
    orders
        The signed order of each flock by the policy's name, as `run_episodes` returns it.
    reference
        Name of the policy that the others are compared with, flock by flock. All policies must have
        led the same flocks, in the same order.

    Returns
    -------
    pandas.DataFrame
        One row per policy, in the order of `orders`: ``policy`` and the columns `SCORE`. Gains are
        NaN for the reference itself, and for all policies without a reference. Intervals are NaN
        for a single flock.

    Raises
    ------
    ParameterError
        For a reference that is not among the policies, for policies without flocks, and for a
        policy whose number of flocks differs from the reference's.
    """
    pandas = require("pandas", "plot")
    orders_by_policy = {
        name: series(values, f"orders[{name!r}]")
        for name, values in by_name(orders, "orders").items()
    }
    if reference is not None:
        refuse_unknown([reference], orders_by_policy, "policy of these")
    rows = []
    for name, values in orders_by_policy.items():
        gain = (np.nan,) * 3
        if reference is not None and name != reference:
            difference = paired_difference(values, orders_by_policy[reference])
            gain = (difference.mean, difference.low, difference.high)
        score = (len(values), *mean_interval(values), *gain)
        rows.append({"policy": name, **dict(zip(SCORE, score, strict=True))})
    table: pd.DataFrame = pandas.DataFrame(rows, columns=["policy", *SCORE])
    return table
