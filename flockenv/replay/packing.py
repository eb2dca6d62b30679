"""Series of numbers, packed small enough for a page that holds an hour of a flock.

Numbers are rounded to a quantum, differenced along time (twice: boats move smoothly), and split
into planes of bytes that compress well. ``packing.mjs`` undoes it.
"""

import base64
import json
import math
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

_DIFFERENCES = 2
# Largest number in quanta: with both differences and the sign it fits 32 bits.
_MOST_QUANTA = 2**28


class Packer:
    """Collects named series, and turns them into text: base64 of gzip of a header and bytes."""

    def __init__(self) -> None:
        self._columns: list[dict[str, Any]] = []
        self._bytes: list[bytes] = []

    def add(self, name: str, values: NDArray[Any], quantum: float) -> None:
        """Add a series that changes smoothly along its first axis.

        Parameters
        ----------
        name
            Its name on the page.
        values
            Shape (t, ...), finite.
        quantum
            Step to which values are rounded; numbers too large for it get a coarser one.
        """
        largest = float(np.abs(values).max(initial=0.0))
        quantum = max(quantum, largest / _MOST_QUANTA)
        quanta = np.rint(np.asarray(values, np.float64) / quantum).astype(np.int64)
        for _ in range(_DIFFERENCES):
            quanta = np.diff(quanta, axis=0, prepend=np.zeros_like(quanta[:1]))
        self._append(name, quanta, quantum, _DIFFERENCES)

    def add_plain(self, name: str, values: NDArray[Any], quantum: float = 1.0) -> None:
        """Add a series that does not change smoothly; its numbers must be at most 2^28 quanta."""
        quanta = np.rint(np.asarray(values, np.float64) / quantum).astype(np.int64)
        self._append(name, quanta, quantum, 0)

    def text(self) -> str:
        """Return all series as base64."""
        header = json.dumps(self._columns, separators=(",", ":")).encode("ascii")
        content = len(header).to_bytes(4, "little") + header + b"".join(self._bytes)
        # The header of gzip holds no time, so pages of the same recording have the same bytes.
        packed = zlib.compressobj(level=6, wbits=31)
        return base64.b64encode(packed.compress(content) + packed.flush()).decode("ascii")

    def _append(
        self, name: str, quanta: NDArray[np.int64], quantum: float, differences: int
    ) -> None:
        """Add the planes of bytes and the header of a series that was differenced already."""
        channels = math.prod(quanta.shape[1:])
        by_channel = np.ascontiguousarray(quanta.reshape(len(quanta), channels).T).reshape(-1)
        # Zigzag encoding: small numbers of either sign become small nonnegative numbers.
        zigzag = ((by_channel << 1) ^ (by_channel >> 63)).astype("<u4")
        planes = np.ascontiguousarray(zigzag.view(np.uint8).reshape(-1, 4).T)
        n_planes = max((plane + 1 for plane in range(4) if planes[plane].any()), default=0)
        self._bytes.append(planes[:n_planes].tobytes())
        self._columns.append(
            {
                "name": name,
                "length": len(quanta),
                "channels": channels,
                "quantum": quantum,
                "differences": differences,
                "planes": n_planes,
            }
        )
