"""The series that a page charts, and their most telling minute."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.flock import OrderSeries
from flockenv.recording import Recording

__all__ = ["ShownQuantity", "shown_quantities", "telling_minute"]

_Series = Callable[[Recording], NDArray[np.float64]]

_MINUTE_S = 60.0
_STEP_S = 0.5
# What a quantity is called, its unit and its range; the range of others is that of the data.
_KNOWN: dict[str, tuple[str, str, tuple[float, float] | None]] = {
    "signed_order": ("order towards target", "", (-1.0, 1.0)),
    "rotation": ("rotation, clockwise positive", "", (-1.0, 1.0)),
    "psi_o": ("order Ψₒ", "", (0.0, 1.0)),
    "phi_o": ("angle φₒ", "rad", (-math.pi, math.pi)),
    "c_o": ("correlation Cₒ", "", None),
    "psi_v": ("velocity Ψᵥ", "cm/s", None),
    "phi_v": ("angle φᵥ", "rad", (-math.pi, math.pi)),
    "c_v": ("correlation Cᵥ", "cm²/s²", None),
}


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

    def facts(self) -> dict[str, Any]:
        """Return what the page's script reads."""
        names = ("key", "words", "unit", "range", "decimals")
        return {name: getattr(self, name) for name in names}


def shown_quantities(recordings: Sequence[Recording]) -> list[ShownQuantity]:
    """Return the quantities that recordings hold; their charts show the first one at first.

    Order towards the target is among them where any of the recordings has leaders.
    """
    series: dict[str, _Series] = {}
    if any(recording.parameters.n_leaders for recording in recordings):
        series["signed_order"] = _signed_order
    series["rotation"] = lambda recording: recording.order.rotation()
    series |= {each.name: attrgetter(f"order.{each.name}") for each in fields(OrderSeries)}
    return [_shown(key, of, recordings) for key, of in series.items()]


def _shown(key: str, of: _Series, recordings: Sequence[Recording]) -> ShownQuantity:
    words, unit, limits = _KNOWN.get(key, (key, "", None))
    values = [of(recording) for recording in recordings]
    largest = max(
        (float(np.nanmax(np.abs(each))) for each in values if _is_defined(each)), default=1.0
    )
    largest = max(map(abs, limits)) if limits else largest
    # Three digits of numbers around the largest, and no more than 6 behind the point.
    decimals = 2 - math.floor(math.log10(largest) + 0.3) if largest > 0 else 2
    return ShownQuantity(key, words, unit, limits, min(max(decimals, 0), 6), of)


def _signed_order(recording: Recording) -> NDArray[np.float64]:
    return recording.order.signed_order(recording.parameters.target)


def _is_defined(values: NDArray[np.float64]) -> bool:
    return bool(np.isfinite(values).all())


def telling_minute(recordings: Sequence[Recording]) -> tuple[float, str]:
    """Return where the most telling minute starts, in s, and what it is in words.

    Of one recording it is the minute in which signed order changes most: the mean over its second
    half minus that over its first, in absolute value. Of two it is the minute in which the mean of
    their difference in signed order is largest. It is the first sample, with no words, where the
    recordings have no whole minute in common or no normal boats.
    """
    begin = max(float(each.time_s[0]) for each in recordings)
    end = min(float(each.time_s[-1]) for each in recordings)
    signed = [_signed_order(each) for each in recordings]
    if end - begin < _MINUTE_S or not all(map(_is_defined, signed)):
        return min(float(each.time_s[0]) for each in recordings), ""
    steps = np.arange(begin, end - _STEP_S / 2, _STEP_S)
    series = [np.interp(steps, each.time_s, s) for each, s in zip(recordings, signed, strict=True)]
    minute = round(_MINUTE_S / _STEP_S)
    if len(series) == 1:
        halves = _means(series[0], minute // 2)
        found = np.abs(halves[minute // 2 :] - halves[: -(minute // 2)]).argmax()
        what = "in which order changes most"
    else:
        found = np.abs(_means(series[0] - series[1], minute)).argmax()
        what = "in which the runs differ most"
    start = float(steps[found])
    return start, f"The page opens at {start:g} s, the beginning of the minute {what}."


def _means(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the mean of each `count` values in a row."""
    sums = np.concatenate([[0.0], values.cumsum()])
    means: NDArray[np.float64] = (sums[count:] - sums[:-count]) / count
    return means
