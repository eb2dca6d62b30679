"""A claim of the paper as a range that a measured quantity must lie in."""

import math
from dataclasses import dataclass

from flockenv.statistics.intervals import CONFIDENCE

__all__ = ["DOES_NOT_HOLD", "HOLDS", "INCONCLUSIVE", "CheckedClaim", "Claim", "number"]

HOLDS = "holds"
DOES_NOT_HOLD = "does not hold"
INCONCLUSIVE = "inconclusive"


def number(value: float) -> str:
    """Return a number in three significant digits, large ones in full; "none" for NaN."""
    if math.isnan(value):
        return "none"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """What the paper says, and how it is judged: fixed before anything is measured.

    The claim holds if the whole interval of the quantity lies in [low, high], it does not hold if
    all of it lies outside, and it is inconclusive otherwise or if the quantity is undefined.

    Attributes
    ----------
    text : str
        The claim in a sentence.
    section : str
        Where the paper makes it.
    quantity : str
        What is measured, with its unit.
    low, high : float
        The range in which the claim is true; either may be infinite.
    """

    text: str
    section: str
    quantity: str
    low: float = -math.inf
    high: float = math.inf

    @property
    def accepted(self) -> str:
        """The range in words."""
        if math.isinf(self.low):
            return f"≤ {self.high:g}"
        return f"≥ {self.low:g}" if math.isinf(self.high) else f"{self.low:g} to {self.high:g}"

    def check(
        self, measured: float, low: float, high: float, scope: str = "", note: str = ""
    ) -> "CheckedClaim":
        """Judge the claim by a measured value and the ends of its interval."""
        if math.isnan(measured) or math.isnan(low) or math.isnan(high):
            verdict = INCONCLUSIVE
        elif self.low <= low and high <= self.high:
            verdict = HOLDS
        elif high < self.low or low > self.high:
            verdict = DOES_NOT_HOLD
        else:
            verdict = INCONCLUSIVE
        return CheckedClaim(self, scope, float(measured), float(low), float(high), verdict, note)


@dataclass(frozen=True, slots=True)
class CheckedClaim:
    """A claim with its verdict.

    Attributes
    ----------
    claim : Claim
        What was judged.
    scope : str
        For what it was measured, such as a preset and a pool.
    measured, low, high : float
        The quantity and the ends of its interval, at level `statistics.intervals.CONFIDENCE`.
    verdict : str
        `HOLDS`, `DOES_NOT_HOLD` or `INCONCLUSIVE`.
    note : str
        What a reader should know besides.
    """

    claim: Claim
    scope: str
    measured: float
    low: float
    high: float
    verdict: str
    note: str = ""

    @property
    def ends(self) -> str:
        """The interval in words."""
        if math.isnan(self.low) or math.isnan(self.high):
            return "none"
        return f"{number(self.low)} to {number(self.high)}"

    def row(self) -> dict[str, str | float]:
        """Return the columns of a claims table."""
        return {
            "claim": self.claim.text,
            "section": self.claim.section,
            "scope": self.scope,
            "quantity": self.claim.quantity,
            "accepted": self.claim.accepted,
            "measured": self.measured,
            "low": self.low,
            "high": self.high,
            "confidence": CONFIDENCE,
            "verdict": self.verdict,
            "note": self.note,
        }
