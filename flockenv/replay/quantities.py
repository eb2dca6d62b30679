"""The series that a page charts, and the minute in which they change most."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.order import QUANTITIES, Quantity
from flockenv.recording import Recording

__all__ = ["ShownQuantity", "decisive_minute", "shown_quantities"]

_Series = Callable[[Recording], NDArray[np.float64]]

_MINUTE_S = 60.0
_STEP_S = 0.5
_SMALL = str.maketrans({"o": "ₒ", "v": "ᵥ", "n": "ₙ"})


@dataclass(frozen=True, slots=True)
class ShownQuantity:
    """A quantity of a recording that the page charts.

    Attributes
    ----------
    key
        Its name in the recording.
    words, unit
        What the page calls it.
    range
        Lowest and highest value of the chart; None for those of the data.
    decimals
        How many the page shows.
    of
        Returns its values in a recording, shape (t,).
    """

    key: str
    words: str
    unit: str
    range: tuple[float, float] | None
    decimals: int
    of: _Series

    @property
    def quantum(self) -> float:
        """What values are rounded to: a twentieth of the last digit that is shown."""
        return 10.0**-self.decimals / 20

    def described(self) -> dict[str, Any]:
        """Return what the page's script reads."""
        names = ("key", "words", "unit", "range", "decimals")
        return {name: getattr(self, name) for name in names}


def shown_quantities(recordings: Sequence[Recording]) -> list[ShownQuantity]:
    """Return the quantities that recordings hold; their charts show the first one at first.

    Order towards the target is among them where in any of the recordings leaders have one.
    """
    table = {each.name: each for each in QUANTITIES if each.kind != "structure"}
    has_target = any(each.parameters.common_target is not None for each in recordings)
    first = ["signed_order", "rotation"] if has_target else ["rotation"]
    recorded = [each.name for each in table.values() if each.kind == "recorded"]
    return [_shown(table[name], recordings) for name in (*first, *recorded)]


def _shown(entry: Quantity, recordings: Sequence[Recording]) -> ShownQuantity:
    limits = entry.range

    def of(recording: Recording) -> NDArray[np.float64]:
        return recording.order.series(entry.name, recording.parameters.target)

    values = [of(recording) for recording in recordings]
    largest = max(
        (float(np.nanmax(np.abs(each))) for each in values if _is_defined(each)), default=1.0
    )
    largest = max(map(abs, limits)) if limits else largest
    # Three digits of numbers around the largest, and no more than 6 behind the point.
    decimals = 2 - math.floor(math.log10(largest) + 0.3) if largest > 0 else 2
    name, _, index = entry.symbol.partition("_")
    symbol = f" {name}{index.translate(_SMALL)}" if index else ""
    words = f"{entry.label}{symbol}"
    return ShownQuantity(entry.name, words, entry.unit, limits, min(max(decimals, 0), 6), of)


def _signed_order(recording: Recording) -> NDArray[np.float64]:
    return recording.order.signed_order(recording.parameters.target)


def _is_defined(values: NDArray[np.float64]) -> bool:
    return bool(np.isfinite(values).all())


def decisive_minute(recordings: Sequence[Recording]) -> tuple[float, str]:
    """Return where the minute of the largest change starts, in s, and what it is in words.

    Of one recording it is the minute in which signed order changes most: the mean over its second
    half minus that over its first, in absolute value. Of two it is the minute in which the mean of
    their difference in signed order is largest. It is the first sample, with no words, where the
    recordings have no whole minute in common or no normal boats.
    """
    first = max(float(each.time_s[0]) for each in recordings)
    end = min(float(each.time_s[-1]) for each in recordings)
    signed = [_signed_order(each) for each in recordings]
    if end - first < _MINUTE_S or not all(map(_is_defined, signed)):
        return min(float(each.time_s[0]) for each in recordings), ""
    steps = np.arange(first, end - _STEP_S / 2, _STEP_S)
    series = [np.interp(steps, each.time_s, s) for each, s in zip(recordings, signed, strict=True)]
    minute = round(_MINUTE_S / _STEP_S)
    if len(series) == 1:
        halves = _means(series[0], minute // 2)
        found = np.abs(halves[minute // 2 :] - halves[: -(minute // 2)]).argmax()
        meaning = "in which order changes most"
    else:
        found = np.abs(_means(series[0] - series[1], minute)).argmax()
        meaning = "in which the runs differ most"
    start = float(steps[found])
    return start, f"The page opens at {start:g} s, the start of the minute {meaning}."


def _means(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the mean of each `count` values in a row."""
    sums = np.concatenate([[0.0], values.cumsum()])
    means: NDArray[np.float64] = (sums[count:] - sums[:-count]) / count
    return means
