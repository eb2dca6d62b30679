"""A flock that a program advances, with its contacts, order parameters and statistics.

The core computes them (order parameters: Section 3.2, in the LAP frame).
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._core import Flock
from flockenv.errors import ParameterError

__all__ = [
    "STATES",
    "ContactSeries",
    "Contacts",
    "Flock",
    "OrderParameters",
    "OrderSeries",
    "Statistics",
]

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
        """Return the collective state at each time (Table 2), shape (t,).

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
            `flockenv.statistics.structure` computes it. None: no state is called clustering.

        Raises
        ------
        ParameterError
            For an array of another length.
        """
        clusters = np.zeros(len(self)) if largest_cluster is None else largest_cluster
        places = _core.collective_states(self.psi_o, self.phi_o, self.psi_v, clusters, speed_cm_s)
        return STATES[places]

    def ordering_time(self, time_s: NDArray[np.float64], within: float = np.pi / 20) -> float:
        """Ordering time τ of a run, eq. (7), in s; infinite if the run does not order.

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
        return _core.ordering_time(time_s, self.psi_o, self.phi_o, within)

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


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Contacts and near-contacts of a flock's last substep, c of them.

    Snapshots do not hold them: a flock that was restored or unpickled has none until its next
    substep, and continues from the same warm-start cache.

    Two nearly parallel hulls, and a hull along the outer wall, touch at two points: two entries.

    Attributes
    ----------
    i : int64 array, shape (c,)
        The boat that the normal pushes.
    j : int64 array, shape (c,)
        The other boat, or -1 for the outer wall, -2 for the inner wall.
    gap_cm : float64 array, shape (c,)
        Distance between the hulls now in cm, negative for overlap.
    normal : float64 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float64 array, shape (c,)
        Mean force on boat i along the normal over the last substep in cm/s² (mass 1), at least 0;
        boat j feels its opposite.
    point_cm : float64 array, shape (c, 2)
        Where boat i is pushed: a point of its hull, world axes.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    gap_cm: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]
    point_cm: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.i)


@dataclass(frozen=True, slots=True, eq=False)
class ContactSeries:
    """Contacts that carried a force, sample after sample: c of them in t samples.

    Attributes
    ----------
    count : int64 array, shape (t,)
        How many contacts each sample has; they follow one another in the other arrays.
    i, j : int32 array, shape (c,)
        The boats, as in `Contacts`: j is -1 for the outer wall, -2 for the inner wall.
    normal : float32 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float32 array, shape (c,)
        Mean force over the substep before the sample in cm/s² (mass 1), above 0.
    point_cm : float32 array, shape (c, 2)
        Where boat i is pushed: a point of its hull, world axes.
    """

    count: NDArray[np.int64]
    i: NDArray[np.int32]
    j: NDArray[np.int32]
    normal: NDArray[np.float32]
    force: NDArray[np.float32]
    point_cm: NDArray[np.float32]

    @classmethod
    def of(cls, samples: Sequence[Contacts]) -> Self:
        """Return the series of contacts that were looked up sample by sample."""
        pushing = [each.force > 0 for each in samples]

        def joined(name: str, dtype: type) -> NDArray[Any]:
            parts = [getattr(each, name)[push] for each, push in zip(samples, pushing, strict=True)]
            return np.concatenate(parts).astype(dtype)

        return cls(
            np.array([push.sum() for push in pushing], np.int64),
            joined("i", np.int32),
            joined("j", np.int32),
            joined("normal", np.float32),
            joined("force", np.float32),
            joined("point_cm", np.float32),
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ContactSeries):
            return NotImplemented
        names = [each.name for each in fields(self)]
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

    def at(self, samples: NDArray[np.bool_]) -> Self:
        """Return the series of some of the samples, shape (t,)."""
        kept = np.repeat(samples, self.count)
        return type(self)(
            self.count[samples],
            self.i[kept],
            self.j[kept],
            self.normal[kept],
            self.force[kept],
            self.point_cm[kept],
        )

    def check(self, samples: int, boats: int) -> None:
        """Check the series of a recording.

        Raises
        ------
        ParameterError
            For arrays of a wrong shape or dtype, boats that are not there, forces that are not
            positive, numbers that are not finite.
        """
        c = len(self.i) if np.ndim(self.i) else 0
        shapes = {"count": (samples,), "normal": (c, 2), "point_cm": (c, 2)}
        dtypes = {"count": np.int64, "i": np.int32, "j": np.int32}
        for each in fields(self):
            array: Any = getattr(self, each.name)
            shape, dtype = shapes.get(each.name, (c,)), dtypes.get(each.name, np.float32)
            if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
                raise ParameterError(
                    f"contacts.{each.name} must be an array of {np.dtype(dtype)}, shape {shape}"
                )
            if not np.isfinite(array).all():
                raise ParameterError(f"contacts.{each.name} must be finite")
        if (self.count < 0).any() or (self.count > c).any() or self.count.sum() != c:
            raise ParameterError(f"contacts.count must add up to the {c} contacts there are")
        if not (_within(self.i, 0, boats) and _within(self.j, -2, boats)):
            raise ParameterError(f"contacts.i and contacts.j must be among {boats} boats")
        if not (self.force > 0).all():
            raise ParameterError("contacts.force must be positive")


@dataclass(frozen=True, slots=True, kw_only=True)
class Statistics:
    """Running totals and worst cases since the flock was made or reset; snapshots carry them.

    Attributes
    ----------
    substeps : int
        Substeps taken.
    solves : int
        Contact problems solved; substeps without a contact have none.
    contacts : int
        Contacts and near-contacts, summed over substeps.
    islands : int
        Islands (boats joined by contacts), summed over solves.
    solver_iterations : int
        Solver iterations, summed over solves and islands.
    factored_rows : int
        Rows of Cholesky factors computed.
    most_factor_entries : int
        Most numbers that the Cholesky factors of one solve held.
    unsolved : int
        Solves whose constraints contradicted each other or that exceeded their residual.
    depenetration_passes : int
        Passes that moved deeply overlapping hulls apart.
    neighbor_builds : int
        Substeps that had to rebuild the neighbor list.
    worst_residual_cm_s : float
        Largest natural residual of a solve in cm/s.
    worst_overlap_cm : float
        Deepest overlap at the beginning of a substep in cm, positive.
    """

    substeps: int
    solves: int
    contacts: int
    islands: int
    solver_iterations: int
    factored_rows: int
    most_factor_entries: int
    unsolved: int
    depenetration_passes: int
    neighbor_builds: int
    worst_residual_cm_s: float
    worst_overlap_cm: float


def _within(numbers: NDArray[np.int32], low: int, end: int) -> bool:
    return bool(((numbers >= low) & (numbers < end)).all())
