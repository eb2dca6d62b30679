"""Order parameters of a recording, which know their times."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.extras import require
from flockenv.errors import ParameterError, shown
from flockenv.flock import OrderSeries

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ORDER", "RECORDED", "RecordedOrder"]

RECORDED = tuple(each for each in _core.quantities() if each.kind == "recorded")
"""The quantities that are recorded with every sample, entries of the table."""

ORDER = tuple(each.name for each in RECORDED)
"""Their names."""


class RecordedOrder(OrderSeries):
    """Order parameters of a recording: an `OrderSeries` that knows its times.

    Attributes
    ----------
    time_s : float64 array, shape (t,)
        Times in s.
    """

    time_s: NDArray[np.float64]

    def __new__(cls, time_s: NDArray[np.float64], order: OrderSeries) -> Self:
        """Take the columns of a series, and its times."""
        series = super().__new__(cls, *(getattr(order, name) for name in ORDER))
        series.time_s = time_s
        return series

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what it is made of, for pickle and copy."""
        plain = OrderSeries(*(getattr(self, name) for name in ORDER))
        return type(self), (self.time_s, plain)

    def plot(
        self, *names: str, target: str | Sequence[str] = "cw", ax: "Axes | None" = None
    ) -> "Axes":
        """Draw quantities against time (extra ``plot``).

        Parameters
        ----------
        names
            Recorded and derived quantities of the table, such as "psi_v" or "signed_order". None:
            the recorded ones that have no unit and lie within known bounds.
        target
            Direction that signed quantities count towards, "cw" or "ccw".
        ax
            Axes of matplotlib to draw into. None: those of a new figure.

        Returns
        -------
        matplotlib.axes.Axes
            With one labeled line per quantity; time in s.

        Raises
        ------
        ParameterError
            For an unknown name or target.
        MissingExtraError
            If matplotlib is not installed.
        """
        pyplot = require("matplotlib.pyplot", "plot")
        known = {each.name: each for each in _core.quantities() if each.kind != "structure"}
        bounded = (each.name for each in RECORDED if each.range is not None and not each.unit)
        shown_names = names or tuple(bounded)
        if unknown := [name for name in shown_names if name not in known]:
            raise ParameterError(
                f"quantity {shown(unknown[0])} is not accepted: {', '.join(known)}"
            )
        columns = {name: self.series(name, target) for name in shown_names}
        axes: Axes = pyplot.subplots()[1] if ax is None else ax
        for name, values in columns.items():
            axes.plot(self.time_s, values, label=_title(known[name]), linewidth=1.0)
        axes.set_xlabel("time [s]")
        axes.legend()
        return axes


def _title(quantity: "_core.Quantity") -> str:
    symbol = f" {quantity.symbol}" if quantity.symbol else ""
    unit = f" [{quantity.unit}]" if quantity.unit else ""
    return f"{quantity.label}{symbol}{unit}"
