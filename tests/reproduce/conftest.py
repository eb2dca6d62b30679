"""Verdicts worked out again from the columns of a claims table."""

import math

import pytest


@pytest.fixture(scope="session")
def follows():
    """Return whether a row's verdict follows from its interval and the range it accepts."""

    def check(row):
        words = str(row["accepted"]).split()
        least, _, most = {
            "≥": lambda: (float(words[1]), "", math.inf),
            "≤": lambda: (-math.inf, "", float(words[1])),
        }.get(words[0], lambda: (float(words[0]), words[1], float(words[2])))()
        low, high = (math.nan if row[end] is None else float(row[end]) for end in ("low", "high"))
        if low == high == 0.0 in (least, most) and math.inf in (-least, most):
            return row["verdict"] == "inconclusive"
        if least <= low <= high <= most:
            return row["verdict"] == "holds"
        if high < least or low > most:
            return row["verdict"] == "does not hold"
        return row["verdict"] == "inconclusive"

    return check
