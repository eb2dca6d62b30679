"""Order parameters of Section 3.2, in the LAP frame. The core computes them."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from flockenv import _core

__all__ = ["STATES", "OrderParameters", "OrderSeries"]

STATES = np.array(_core.collective_state_names())
"""Names of the collective states (Table 2; ordered motion by its direction)."""


@dataclass(frozen=True, slots=True)
class OrderParameters:
    """Alignment of a set of boats at one time.

    LAP angles count clockwise from the outward radial: 0 is jammed outward, +π/2 clockwise.

    Attributes
    ----------
    psi_o : float
        Ψ_o, length of the mean orientation in [0, 1] (eq. 1); some 0.886/√N for N disordered boats.
    phi_o : float
        φ_o, angle of the mean orientation in (-π, π] (eq. 3).
    c_o : float
        C_o, mean dot product of the orientations of two different boats in [-1, 1] (eq. 2, each
        pair once); NaN for a single boat.
    psi_v : float
        Ψ_v, length of the mean velocity in cm/s (eq. 4).
    phi_v : float
        φ_v, angle of the mean velocity in (-π, π] (eq. 6).
    c_v : float
        C_v, mean dot product of the velocities of two different boats in cm²/s² (eq. 5); NaN for a
        single boat.
    """

    psi_o: float
    phi_o: float
    c_o: float
    psi_v: float
    phi_v: float
    c_v: float


@dataclass(frozen=True, slots=True, eq=False)
class OrderSeries:
    """Order parameters one after another: the fields of `OrderParameters` as float64 arrays (t,).

    All NaN if there is no boat to take them of; ``c_o`` and ``c_v`` NaN for a single boat.
    """

    psi_o: NDArray[np.float64]
    phi_o: NDArray[np.float64]
    c_o: NDArray[np.float64]
    psi_v: NDArray[np.float64]
    phi_v: NDArray[np.float64]
    c_v: NDArray[np.float64]

    def signed_order(self, target: str) -> NDArray[np.float64]:
        """Ψ_o·cos(φ_o - φ_target) in [-1, 1], shape (t,), for target "cw" or "ccw".

        Raises
        ------
        ParameterError
            For an unknown target.
        """
        return _core.signed_order(self.psi_o, self.phi_o, target)

    def rotation(self) -> NDArray[np.float64]:
        """Ψ_o·sin φ_o in [-1, 1], shape (t,): ±1 for rotation in order, 0 for a jam."""
        return _core.rotation(self.psi_o, self.phi_o)

    def outward(self) -> NDArray[np.float64]:
        """Ψ_o·cos φ_o in [-1, 1], shape (t,): 1 for a jam, near 0 for streams along the pool.

        It is the mean of cos φ over boats, so that opposed streams do not cancel as in `rotation`.
        """
        return _core.outward(self.psi_o, self.phi_o)

    def off_tangent(self) -> NDArray[np.float64]:
        """||φ_o| - π/2| in [0, π/2] rad, shape (t,): 0 for boats that point along the pool."""
        return _core.off_tangent(self.phi_o)

    def states(
        self, speed_cm_s: float, largest_cluster: NDArray[np.float64] | None = None
    ) -> NDArray[np.str_]:
        """Tell the collective state at each time (Table 2), shape (t,).

        Meant for times in the analysis window. ``"ordered cw"`` and ``"ordered ccw"``: Ψ_o above
        0.8, φ_o within π/4 of ±π/2, Ψ_v at least a quarter of the preferred speed. ``"jamming"``:
        Ψ_o above 0.8, φ_o within π/4 of 0, Ψ_v below that. ``"disordered"``: Ψ_o below 0.5.
        ``"clustering"``: the same, with at least three quarters of the boats in one cluster.
        ``"between"``: none of these.

        Parameters
        ----------
        speed_cm_s
            Preferred forward speed of the boats.
        largest_cluster
            Part of the boats in the largest cluster, shape (t,), as `largest_cluster` of
            `flockenv.arrangement` tells it. None: no state is called clustering.

        Raises
        ------
        ParameterError
            For an array of another length.
        """
        clusters = np.zeros(len(self)) if largest_cluster is None else largest_cluster
        places = _core.collective_states(self.psi_o, self.phi_o, self.psi_v, clusters, speed_cm_s)
        return STATES[places]

    def ordering_time(self, time_s: NDArray[np.float64], within: float = np.pi / 20) -> float:
        """Ordering time τ of a run, eq. (7), in s; NaN if the run does not order.

        The first time at which Ψ_o > 0.8 and ||φ_o| - π/2| < `within`, if mean Ψ_o over the second
        half of the run exceeds 0.8.

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
        time = _core.ordering_time(time_s, self.psi_o, self.phi_o, within)
        return float("nan") if time is None else time

    def __len__(self) -> int:
        return len(self.psi_o)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, OrderSeries):
            return NotImplemented
        names = [each.name for each in fields(self)]
        pairs = ((getattr(self, name), getattr(other, name)) for name in names)
        return all(np.array_equal(mine, theirs, equal_nan=True) for mine, theirs in pairs)

    def __getitem__(self, index: int) -> OrderParameters:
        return OrderParameters(*(float(getattr(self, each.name)[index]) for each in fields(self)))
