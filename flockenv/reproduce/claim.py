"""A claim of the paper as a range that a measured quantity must lie in."""

import math
from dataclasses import dataclass, replace

from flockenv.statistics.intervals import CONFIDENCE

__all__ = [
    "DOES_NOT_HOLD",
    "FEWEST_RUNS",
    "HOLDS",
    "INCONCLUSIVE",
    "CheckedClaim",
    "Claim",
    "number",
]

HOLDS = "holds"
DOES_NOT_HOLD = "does not hold"
INCONCLUSIVE = "inconclusive"

FEWEST_RUNS = 8
"""Seeds from which runs count in a claim of a study beyond the paper."""

_FAR = 100
"""So many times as many runs are not worth a number."""


def number(value: float) -> str:
    """Return a number in three significant digits, large ones in full; "none" for NaN."""
    if math.isnan(value):
        return "none"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """What the paper says, and how it is judged: fixed before anything is measured.

    The claim holds if the whole interval of the quantity lies in [low, high], it does not hold if
    all of it lies outside, and it is inconclusive otherwise, if the quantity is undefined, or if it
    is exactly 0 where a sign is claimed.

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

    @property
    def claims_sign(self) -> bool:
        """Whether the range is that of all positive or of all negative numbers, with 0."""
        return (self.low, self.high) in ((0.0, math.inf), (-math.inf, 0.0))

    def check(
        self, measured: float, low: float, high: float, scope: str = "", note: str = ""
    ) -> "CheckedClaim":
        """Judge the claim by a measured value and the ends of its interval."""
        if math.isnan(measured) or math.isnan(low) or math.isnan(high):
            verdict = INCONCLUSIVE
        elif low == high == 0.0 and self.claims_sign:
            # No draw shows any difference, which is not evidence for its sign.
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

    def of_seeds(self, runs: int) -> "CheckedClaim":
        """Return the claim, inconclusive where it hangs on fewer seeds than `FEWEST_RUNS`."""
        if runs >= FEWEST_RUNS:
            return self
        note = f"inconclusive: needs {FEWEST_RUNS} seeds, where it has {runs}"
        return replace(self, verdict=INCONCLUSIVE, note=note)

    def with_needs(self, runs: int, what: str) -> "CheckedClaim":
        """Return the claim; an open one says how many such runs would decide it.

        Parameters
        ----------
        runs
            How many there are.
        what
            What they are, in words: "seeds".
        """
        if self.verdict != INCONCLUSIVE:
            return self
        nearest = min(abs(self.measured - bound) for bound in (self.claim.low, self.claim.high))
        half = max(self.measured - self.low, self.high - self.measured)
        if not half >= 0.0:
            needs = "longer runs: it is undefined in these"
        elif half**2 >= _FAR * nearest**2:
            needs = f"more than {_FAR} times as many {what}"
        else:
            needs = f"about {math.ceil(runs * (half / nearest) ** 2)} {what}, where it has {runs}"
        note = f"inconclusive: needs {needs}"
        return replace(self, note=f"{self.note}; {note}" if self.note else note)

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
