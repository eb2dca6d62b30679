"""The series that a page charts, and the minute in which they change most."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.order import ORDER, QUANTITIES
from flockenv.recording import Recording

_MINUTE_S = 60.0
# Runs are compared at times this far apart.
_STEP_S = 0.5
_SUBSCRIPTS = str.maketrans({"o": "ₒ", "v": "ᵥ", "n": "ₙ"})


def series_of(recording: Recording, key: str) -> NDArray[np.float64]:
    """Return a quantity of a recording, shape (t,); signed order is towards its target."""
    return recording.order.series(key, recording.parameters.target)


def shown_quantities(recordings: Sequence[Recording]) -> list[dict[str, Any]]:
    """Return the quantities that a page charts, as its script reads them. It opens with the first.

    Each has ``key``, its name in the recording; ``words`` and ``unit``; ``range``, the lowest and
    highest value of its chart, or None for the range of the data; and ``decimals``, the number of
    decimals. Order towards the target is among them if leaders have a target in any of the
    recordings.
    """
    has_target = any(recording.parameters.common_target is not None for recording in recordings)
    keys = [*(["signed_order"] if has_target else []), "rotation", *ORDER]
    table = {quantity.name: quantity for quantity in QUANTITIES}
    charted = []
    for key in keys:
        quantity = table[key]
        series = [series_of(recording, key) for recording in recordings]
        finite = [values for values in series if np.isfinite(values).all()]
        limits = quantity.range or [np.abs(values).max() for values in finite]
        largest = max(map(abs, limits), default=1.0)
        # Two or three significant digits of the largest number, at most 6 decimals.
        decimals = 2 - math.floor(math.log10(largest) + 0.3) if largest > 0 else 2
        name, _, index = quantity.symbol.partition("_")
        symbol = f" {name}{index.translate(_SUBSCRIPTS)}" if index else ""
        charted.append(
            {
                "key": key,
                "words": f"{quantity.label}{symbol}",
                "unit": quantity.unit,
                "range": quantity.range,
                "decimals": min(max(decimals, 0), 6),
            }
        )
    return charted


def decisive_minute(recordings: Sequence[Recording]) -> tuple[float, str]:
    """Return the start in s of the minute with the largest change, and a description.

    For one recording it is the minute in which signed order changes most: the mean over the
    minute's second half minus that over its first, in absolute value. For two it is the minute in
    which their mean difference in signed order is largest. If the recordings have no whole minute
    in common, or a sample has no signed order, the result is the time of the first sample and an
    empty text.
    """
    common_start = max(float(recording.time_s[0]) for recording in recordings)
    common_end = min(float(recording.time_s[-1]) for recording in recordings)
    signed = [series_of(recording, "signed_order") for recording in recordings]
    if common_end - common_start < _MINUTE_S or not all(
        np.isfinite(series).all() for series in signed
    ):
        return min(float(recording.time_s[0]) for recording in recordings), ""
    times_s = np.arange(common_start, common_end - _STEP_S / 2, _STEP_S)
    series = [
        np.interp(times_s, recording.time_s, values)
        for recording, values in zip(recordings, signed, strict=True)
    ]
    steps_per_minute = round(_MINUTE_S / _STEP_S)
    half = np.full(steps_per_minute // 2, 1.0)
    if len(series) == 1:
        # np.convolve reverses the weights.
        weights, compared = np.concatenate([half, -half]), series[0]
        meaning = "in which order changes most"
    else:
        weights, compared = np.concatenate([half, half]), series[0] - series[1]
        meaning = "in which the runs differ most"
    # Minutes whose changes differ by rounding errors alone count as equal, and the first one wins.
    changes = np.abs(np.convolve(compared, weights, "valid").round(9))
    index = changes.argmax()
    start = float(times_s[index])
    return start, f"The page opens at {start:g} s, the start of the minute {meaning}."
