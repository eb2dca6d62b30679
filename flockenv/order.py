"""Order parameters and the other recorded quantities, at one time and at many (Section 3.2).

The core computes them in the LAP frame; its table of quantities names them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, make_dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import with_gaps
from flockenv._io.extras import require
from flockenv.errors import HintsAtNames, ParameterError, short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STATES = np.array(_core.COLLECTIVE_STATES)
"""Names of the collective states (Table 2; ordered motion by its direction)."""


@dataclass(frozen=True)
class Quantity:
    """An entry of the table of quantities."""

    #: Name in recordings and tables.
    name: str
    #: A few words for axes and legends.
    label: str
    symbol: str
    #: Empty for none.
    unit: str
    #: Meaning, with its sign.
    meaning: str
    #: The paper's equation, or another definition.
    source: str
    #: Least and greatest value, or None.
    range: tuple[float, float] | None
    #: Least number of boats for which it is defined; NaN for fewer.
    least_boats: int
    #: Whether its mean over a run is shown; the mean of an angle is not.
    is_averaged: bool
    #: ``"recorded"`` with every sample, ``"derived"`` from recorded ones and the target direction,
    #: or ``"structure"``: computed from poses on request.
    kind: str

    @property
    def title(self) -> str:
        """Label, symbol and unit, as axes show them."""
        symbol = f" {self.symbol}" if self.symbol else ""
        unit = f" [{self.unit}]" if self.unit else ""
        return f"{self.label}{symbol}{unit}"


QUANTITIES = tuple(Quantity(**entry) for entry in _core.QUANTITIES)
"""The table of quantities."""

RECORDED = tuple(quantity for quantity in QUANTITIES if quantity.kind == "recorded")
"""The quantities that are recorded with every sample."""

ORDER = tuple(quantity.name for quantity in RECORDED)
"""Names of the recorded quantities."""

_MEANINGS = {
    "psi": "'psi_o', of headings, or 'psi_v', of velocities",
    "psi_0": "'psi_o'",
    "phi": "'phi_o', of headings, or 'phi_v', of velocities",
    "polarization": "'psi_o', of headings in the frame of the pool",
    **dict.fromkeys(("order", "signed_order"), "'psi_o', or 'signed_order()' of a series"),
}

_T = TypeVar("_T")
_NAN: Any = math.nan

if TYPE_CHECKING:
    # The recorded quantities, written out for editors and mypy; a test compares both.
    @dataclass(frozen=True, eq=False)
    class _Recorded(Generic[_T]):
        psi_o: _T = _NAN
        phi_o: _T = _NAN
        c_o: _T = _NAN
        psi_v: _T = _NAN
        phi_v: _T = _NAN
        c_v: _T = _NAN
        nematic: _T = _NAN
        milling: _T = _NAN

else:
    _Recorded = make_dataclass(
        "_Recorded",
        [(name, Any, field(default=_NAN)) for name in ORDER],
        namespace={"__class_getitem__": classmethod(lambda cls, kind: cls)},
        frozen=True,
        eq=False,
    )


class OrderParameters(_Recorded[float], HintsAtNames):
    """Alignment of a set of boats at one time: a float for each recorded quantity of the table.

    LAP angles count clockwise from the outward radial: 0 is jammed outward, +π/2 clockwise. Values
    that are not given are NaN, and NaN equals NaN here.
    """

    _meanings: ClassVar[Mapping[str, str]] = _MEANINGS

    def _values(self) -> tuple[float | None, ...]:
        """Return the values, with None for NaN, because None equals None."""
        values = (getattr(self, name) for name in ORDER)
        return tuple(None if math.isnan(value) else value for value in values)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, OrderParameters):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())


@dataclass(frozen=True, eq=False)
class OrderSeries(_Recorded[NDArray[np.float64]], HintsAtNames):
    """Order parameters at many times: the fields of `OrderParameters` as float64 arrays (t,).

    All are NaN if there is no boat; ``c_o`` and ``c_v`` are NaN for a single boat. Columns that are
    not given are NaN. Series are equal if their columns are.

    Attributes
    ----------
    time_s : float64 array, shape (t,), or None
        Times in s, if a recording has the series.
    """

    _meanings: ClassVar[Mapping[str, str]] = _MEANINGS

    time_s: NDArray[np.float64] | None = field(default=None, repr=False, kw_only=True)

    def __post_init__(self) -> None:
        lengths = [len(column) for column in self.columns() if np.ndim(column)]
        for name in ORDER:
            if not np.ndim(getattr(self, name)):
                missing_column = np.full(lengths[0] if lengths else 0, np.nan)
                object.__setattr__(self, name, missing_column)

    def columns(self) -> tuple[NDArray[np.float64], ...]:
        """Return the columns, in the order of the table."""
        return tuple(getattr(self, name) for name in ORDER)

    def at(
        self,
        samples: slice | NDArray[np.bool_ | np.integer[Any]],
        time_s: NDArray[np.float64] | None = None,
    ) -> "OrderSeries":
        """Return the samples that a NumPy index selects, as a series with the times `time_s`."""
        return OrderSeries(*(column[samples] for column in self.columns()), time_s=time_s)

    def __len__(self) -> int:
        return len(self.columns()[0])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, OrderSeries):
            return NotImplemented
        pairs = zip(self.columns(), other.columns(), strict=True)
        return all(np.array_equal(mine, theirs, equal_nan=True) for mine, theirs in pairs)

    def __getitem__(self, index: int) -> OrderParameters:
        return OrderParameters(*(float(column[index]) for column in self.columns()))

    def _order_columns(self) -> dict[str, NDArray[np.float64]]:
        """Return the columns from which the core derives other quantities and states."""
        return {name: with_gaps(getattr(self, name), name) for name in ("psi_o", "phi_o", "psi_v")}

    def series(self, name: str, target: str | Sequence[str] = "cw") -> NDArray[np.float64]:
        """Return the values of a recorded or derived quantity, shape (t,).

        Parameters
        ----------
        name
            Its name in the table of quantities.
        target
            Direction in which signed quantities are positive, "cw" or "ccw". In a list only the
            first entry counts.

        Raises
        ------
        ParameterError
            For an unknown name or target.
        """
        known = {quantity.name: quantity for quantity in QUANTITIES if quantity.kind != "structure"}
        if name not in known:
            raise ParameterError(
                f"quantity = {short_repr(name)} is not accepted: {', '.join(known)}"
            )
        if known[name].kind == "recorded":
            # For derived quantities, the core checks the target.
            targets = [target] if isinstance(target, str) else target
            if not set(targets) <= {"cw", "ccw"}:
                raise ParameterError(
                    f"target = {short_repr(target)} is not accepted: 'cw' or 'ccw'"
                )
            column: NDArray[np.float64] = getattr(self, name)
            return column
        return _core.derived_series(name, self._order_columns(), target)

    def signed_order(self, target: str | Sequence[str]) -> NDArray[np.float64]:
        """Return Ψ_o·cos(φ_o - φ_target) in [-1, 1], shape (t,), for target "cw" or "ccw".

        In a list of targets only the first counts. Raises the errors of `series`.
        """
        return self.series("signed_order", target)

    def rotation(self) -> NDArray[np.float64]:
        """Return Ψ_o·sin φ_o in [-1, 1], shape (t,): ±1 for rotation in order, 0 for a jam."""
        return self.series("rotation")

    def outward(self) -> NDArray[np.float64]:
        """Return Ψ_o·cos φ_o in [-1, 1], shape (t,): 1 for a jam, 0 for streams along the pool.

        It is the mean of cos φ over boats. A boat along the pool adds 0, whether it circulates
        clockwise or counter-clockwise.
        """
        return self.series("outward")

    def states(
        self, speed_cm_s: float, largest_cluster: NDArray[np.float64] | None = None
    ) -> NDArray[np.str_]:
        """Return the collective state at each time (Table 2), shape (t,).

        Meant for times in the analysis window. ``"ordered cw"`` and ``"ordered ccw"``: Ψ_o above
        0.8, φ_o within π/4 of ±π/2, Ψ_v at least a quarter of the preferred speed. ``"jamming"``:
        Ψ_o above 0.8, φ_o within π/4 of 0, Ψ_v below a quarter of that speed. ``"disordered"``: Ψ_o
        below 0.5. ``"clustering"``: the same, with at least three quarters of the boats in one
        cluster.
        ``"between"``: none of these.

        Parameters
        ----------
        speed_cm_s
            Preferred forward speed of the boats.
        largest_cluster
            Fraction of the boats in the largest cluster at each time, shape (t,), the quantity of
            that name. None: no state is called clustering.

        Raises
        ------
        ParameterError
            For an array of another length.
        """
        orders = self._order_columns()
        if largest_cluster is None:
            largest_cluster = np.zeros(len(orders["psi_o"]))
        return STATES[_core.collective_states(orders, speed_cm_s, largest_cluster)]

    def ordering_time(self, time_s: ArrayLike, within: float = math.pi / 20.0) -> float:
        """Return the ordering time τ of a run, eq. (7), in s; infinite if the run does not order.

        It is the first time at which Ψ_o > 0.8 and ||φ_o| - π/2| < `within`, if mean Ψ_o over the
        second half of the run exceeds 0.8.

        Parameters
        ----------
        time_s
            Times of the series, shape (t,).
        within
            Angle in rad: π/20 as printed, or a wider one.

        Raises
        ------
        ParameterError
            For times of another length.
        """
        return _core.ordering_time_s(self._order_columns(), with_gaps(time_s, "time_s"), within)

    def plot(
        self, *names: str, target: str | Sequence[str] = "cw", ax: "Axes | None" = None
    ) -> "Axes":
        """Draw quantities of a recording's series against time (needs the extra ``plot``).

        Parameters
        ----------
        names
            Recorded and derived quantities, such as "psi_v" or "signed_order". Without names: the
            recorded quantities that have no unit and lie within known bounds.
        target
            Direction in which signed quantities are positive, "cw" or "ccw".
        ax
            Axes of matplotlib to draw into. None: a new figure.

        Returns
        -------
        matplotlib.axes.Axes
            With one labeled line per quantity; time in s.

        Raises
        ------
        ParameterError
            For an unknown name or target, and for a series without times.
        MissingExtraError
            If matplotlib is not installed.
        """
        pyplot = require("matplotlib.pyplot", "plot")
        if self.time_s is None:
            raise ParameterError("this series has no times: plot a recording's order")
        if not names:
            names = tuple(
                quantity.name for quantity in RECORDED if quantity.range and not quantity.unit
            )
        columns = {name: self.series(name, target) for name in names}
        axes: Axes = pyplot.subplots()[1] if ax is None else ax
        titles = {quantity.name: quantity.title for quantity in QUANTITIES}
        for name, values in columns.items():
            axes.plot(self.time_s, values, label=titles[name], linewidth=1.0)
        axes.set_xlabel("time [s]")
        axes.legend()
        return axes


def order_series(pose: ArrayLike, velocity: ArrayLike) -> OrderSeries:
    """Return the recorded quantities of any boats, robots or animals at each time.

    Parameters
    ----------
    pose
        Shape (t, n, 3): [x, y from the pool's center, heading rad counter-clockwise from x]. A row
        of NaN stands for a missing boat. Leaders, if there are any, count like other boats.
    velocity
        The same shape, in the unit of length of the pose per s.

    Returns
    -------
    OrderSeries
        Section 3.2's order parameters, the nematic order and milling, of the boats that have both a
        pose and a velocity; NaN at times with too few of them.

    Raises
    ------
    ParameterError
        For other shapes, and for values that are not numbers.
    """
    motion = {"pose": with_gaps(pose, "pose"), "velocity": with_gaps(velocity, "velocity")}
    for name, values in motion.items():
        if values.ndim != 3:
            raise ParameterError(f"{name} has shape {values.shape}, expected (t, n, 3)")
    return OrderSeries(**_core.order_columns(**motion))
