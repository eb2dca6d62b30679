"""Order parameters of Section 3.2, in the LAP frame. The core computes them."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from flockenv import _core

__all__ = ["OrderParameters", "OrderSeries"]


@dataclass(frozen=True, slots=True)
class OrderParameters:
    """Alignment of a set of boats at one time.

    LAP angles count clockwise from the outward radial: 0 is jammed outward, +π/2 clockwise.

    Attributes
    ----------
    psi_o : float
        Ψ_o = |mean orientation| in [0, 1] (eq. 1). N disordered boats have about 0.886/√N.
    phi_o : float
        φ_o, angle of the mean orientation in (-π, π] (eq. 3).
    c_o : float
        C_o, mean dot product of the orientations of two different boats in [-1, 1] (eq. 2, each
        pair once); NaN for a single boat.
    psi_v : float
        Ψ_v = |mean velocity| in cm/s (eq. 4).
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
