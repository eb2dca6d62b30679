"""A flock that a program advances, with its contacts, order parameters and statistics."""

import base64
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import as_bool, as_bytes, materialized
from flockenv.errors import HintsAtNames, ParameterError
from flockenv.order import OrderParameters
from flockenv.parameters import FlockParameters

_NOTEBOOK_PIXELS = 400


class _Columns:
    """Arrays that are equal if all of them are."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        columns = (each.name for each in fields(self))  # type: ignore[arg-type]
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in columns)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False)
class Contacts(_Columns):
    """Contacts and near-contacts of a flock's last substep, c of them.

    Snapshots do not hold them: a flock that was restored or unpickled has none until its next
    substep, and continues from the same warm-start cache.

    Two nearly parallel hulls, and a hull along the outer wall, touch at two points: two entries.

    Attributes
    ----------
    i : int64 array, shape (c,)
        The boat that the normal pushes.
    j : int64 array, shape (c,)
        The other boat, or -1 for the outer wall, -2 for the inner wall, and from -3 downwards the
        obstacles: the discs in their order, then the walls.
    gap_cm : float64 array, shape (c,)
        Distance between the hulls now in cm, negative for overlap.
    normal : float64 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float64 array, shape (c,)
        Mean force on boat i along the normal over the last substep in cm/s² (mass 1), at least 0;
        boat j feels its opposite.
    point_cm : float64 array, shape (c, 2)
        Where boat i is pushed: a point of its hull, world axes.
    along_cm : float64 array, shape (c,)
        The same along its core, from its center to the bow.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    gap_cm: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]
    point_cm: NDArray[np.float64]
    along_cm: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.i)


@dataclass(frozen=True, eq=False)
class ContactSeries(_Columns):
    """Contacts that carried a force, sample after sample: c of them in t samples.

    Attributes
    ----------
    count : int64 array, shape (t,)
        How many each sample has; they follow one another in the other arrays.
    i, j : int32 array, shape (c,)
        The boats, as in `Contacts`.
    normal, force, point_cm, along_cm : float32 array, shapes (c, 2), (c,), (c, 2), (c,)
        As in `Contacts`; the force, above 0, is the mean over the substep before the sample.
    """

    count: NDArray[np.int64]
    i: NDArray[np.int32]
    j: NDArray[np.int32]
    normal: NDArray[np.float32]
    force: NDArray[np.float32]
    point_cm: NDArray[np.float32]
    along_cm: NDArray[np.float32]

    @classmethod
    def from_columns(cls, columns: Mapping[str, NDArray[Any]]) -> Self:
        """Return the series with these of its columns, by name; others are left out."""
        return cls(*(columns[each.name] for each in fields(cls)))

    def at(self, samples: NDArray[np.bool_]) -> "ContactSeries":
        """Return the contacts of some of the samples, shape (t,)."""
        chosen = np.repeat(samples, self.count)
        each = (getattr(self, field.name)[chosen] for field in fields(self)[1:])
        return ContactSeries(self.count[samples], *each)


@dataclass(frozen=True, kw_only=True)
class Statistics:
    """Running sums and worst cases since the flock was made or reset; snapshots carry them.

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
        Substeps that left overlaps deeper than the tolerance.
    halved_substeps : int
        Halvings of substeps: they left overlaps deeper than the tolerance, contacts would have
        driven boats, or a boat moved too far.
    depenetration_passes : int
        Passes that moved deeply overlapping hulls apart.
    neighbor_builds : int
        Substeps that had to rebuild the neighbor list.
    worst_residual_cm_s : float
        Largest natural residual of a solve in cm/s.
    worst_overlap_cm : float
        Deepest overlap at the start of a substep in cm, positive.
    displaced_angular_momentum_cm2_s : float
        Sum of the absolute changes of the angular momentum about the pool's center, in cm²/s for
        boats of mass 1, when deeply overlapping hulls were moved apart.
    worst_error_cm : float
        Largest error that `Flock.advance_with_error` stated, in cm; 0 if it was not called.
    """

    substeps: int
    solves: int
    contacts: int
    islands: int
    solver_iterations: int
    factored_rows: int
    most_factor_entries: int
    unsolved: int
    halved_substeps: int
    depenetration_passes: int
    neighbor_builds: int
    worst_residual_cm_s: float
    worst_overlap_cm: float
    displaced_angular_momentum_cm2_s: float
    worst_error_cm: float


@dataclass(frozen=True, kw_only=True)
class StepStatistics:
    """Whether a run kept its tolerance; as in `Statistics`.

    Attributes
    ----------
    worst_overlap_cm : float
        Deepest overlap at the start of a substep in cm, positive.
    unsolved : int
        Substeps that left overlaps deeper than the tolerance.
    halved_substeps : int
        Halvings of substeps.
    """

    worst_overlap_cm: float
    unsolved: int
    halved_substeps: int

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if not (math.isfinite(value) and value >= 0):
                raise ParameterError(f"{each.name} = {value} is not accepted: at least 0")


STEP_STATISTICS = tuple(each.name for each in fields(StepStatistics))
"""Names of the `StepStatistics`, as in tables and summaries of episodes."""


class Flock(HintsAtNames):
    """A flock of boats in a pool.

    Boats are placed at random without overlap, at rest; leaders are boats 0 to k - 1. The same
    parameters and seed give the same bits on one machine, through snapshots, pickles and copies
    too. The interpreter lock is released while the flock moves.

    Parameters
    ----------
    parameters : FlockParameters
        Of the flock.
    seed : int
        Seed of all random streams, 0 to 2^64 - 1.

    Raises
    ------
    ParameterError
        If the boats do not fit the pool, and for a seed out of range.
    InUseError
        From every method and attribute, while another thread is at work with the flock.
    """

    __slots__ = ("_in_core",)
    _meanings: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("position", "positions", "poses", "headings"), "'pose'"),
        **dict.fromkeys(("velocities", "speed", "speeds"), "'velocity'"),
        **dict.fromkeys(("time", "t"), "'time_s'"),
        **dict.fromkeys(("step", "run", "simulate"), "'advance'"),
        **dict.fromkeys(("order", "psi_o", "psi_v", "polarization"), "'order_parameters()'"),
        **dict.fromkeys(
            ("boats", "n_boats", "leaders", "bw_s", "pool"), "an entry of 'parameters'"
        ),
    }

    def __init__(self, parameters: FlockParameters, seed: int) -> None:
        self._in_core = _core.Flock(parameters, seed)

    @classmethod
    def _from_core(cls, core: _core.Flock) -> Self:
        """Return the flock of a simulator in the core."""
        flock = cls.__new__(cls)
        flock._in_core = core
        return flock

    @classmethod
    def from_snapshot(cls, snapshot: bytes, noise_seed: int | None = None) -> Self:
        """Return the flock of a snapshot; `noise_seed` is as for `restore`.

        A ParameterError refuses bytes that are no whole, unharmed snapshot.
        """
        return cls._from_core(_core.Flock.from_snapshot(as_bytes(snapshot, "snapshot"), noise_seed))

    @classmethod
    def from_state(cls, parameters: FlockParameters, seed: int, state: Mapping[str, Any]) -> Self:
        """Return a flock in a given state.

        Parameters
        ----------
        parameters, seed
            As of the class.
        state
            ``pose`` (n, 3) and, if need be, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``,
            as in `set_state`, whose errors these are. Other keys are refused.
        """
        return cls._from_core(_core.Flock.from_state(parameters, seed, state))

    def reset(self, seed: int) -> None:
        """Start over with another seed, as a new flock with these parameters.

        If the boats do not fit the pool, a ParameterError leaves the flock unchanged.
        """
        self._in_core.reset(seed)

    @property
    def parameters(self) -> FlockParameters:
        """The parameters, with the target that holds now."""
        return FlockParameters._from_core(self._in_core.parameters)

    @property
    def seed(self) -> int:
        """Seed of all random streams."""
        return self._in_core.seed

    @property
    def noise_seed(self) -> int | None:
        """Seed of the noise if the flock continues a snapshot with other noise; None otherwise."""
        return self._in_core.noise_seed

    @property
    def pose(self) -> NDArray[np.float64]:
        """Poses, a copy: (n, 3) [x cm, y cm, heading rad counter-clockwise from x, not wrapped]."""
        return self._in_core.pose

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocities, a copy: (n, 3) [cm/s, cm/s, rad/s].

        With the leapfrog scheme these are means over the last substep.
        """
        return self._in_core.velocity

    @property
    def time_s(self) -> float:
        """Time in s."""
        return self._in_core.time_s

    @property
    def in_analysis_window(self) -> bool:
        """Whether the flock is in the second half of fw or the first half of nop1 now."""
        return self._in_core.in_analysis_window

    @property
    def phase(self) -> str:
        """Phase that holds from now on: "fw", "nop1", "bw" or "nop2"."""
        return self._in_core.phase

    @property
    def statistics(self) -> Statistics:
        """Sums and worst cases of the substeps since the flock was made."""
        return Statistics(**self._in_core.statistics)

    def set_state(
        self,
        pose: ArrayLike,
        velocity: ArrayLike,
        time_s: float = 0.0,
        *,
        allow_overlap: bool = False,
    ) -> None:
        """Set poses, velocities and time.

        Parameters
        ----------
        pose
            Shape (n, 3): [x cm, y cm, heading rad].
        velocity
            Shape (n, 3): [cm/s, cm/s, rad/s].
        time_s
            Time in s, 0 to 1e9.
        allow_overlap
            Accept hulls that overlap each other or a wall by more than a hundredth of their radius;
            contacts leave less. The next substeps move them apart.

        Raises
        ------
        ParameterError
            For wrong shapes, numbers that are not finite, and overlaps; the flock is unchanged
            then.
        TypeError
            For arrays that are not of real numbers.
        """
        state = {"pose": pose, "velocity": velocity, "time_s": time_s}
        self._in_core.set_state({**state, "allow_overlap": allow_overlap})

    def set_target(self, target: str | Sequence[str]) -> None:
        """Change the direction that leaders head for by the paper's law.

        A ParameterError, which leaves the flock unchanged, refuses another name, and a list of
        another length.

        Parameters
        ----------
        target
            "cw" or "ccw", or a list with one per leader.
        """
        self._in_core.set_target(materialized(target))

    def advance(self, seconds: float, rudder: ArrayLike | None = None) -> None:
        """Advance by a duration. Substeps end on multiples of dt_s, on phase switches, at the end.

        Parameters
        ----------
        seconds
            Duration in s, at least 0.
        rudder
            Commands of the leaders in [-1, 1], shape (k,), held; positive turns a boat that moves
            forward counter-clockwise. None: the paper's law, eq. (10), at every substep.

        Raises
        ------
        ParameterError
            For a duration or rudder out of range or of a wrong shape; the flock is unchanged then.
        SolverError
            If the motion left its range of 1e9 (cm, cm/s, rad, rad/s); poses, velocities and time
            are those before the call.
        """
        self._in_core.advance(seconds, rudder)

    def advance_with_error(self, seconds: float, rudder: ArrayLike | None = None) -> float:
        """Advance as `advance` does, and return the error in cm that dt_s made on the way.

        The error is the distance from where substeps of dt_s / 8 lead from the same start, with the
        same noise: the root mean square over boats of ``|Δx|² + ρ²Δα²``, with the radius of
        gyration ρ. It takes nine times as long. Errors of successive advances do not add up.

        Parameters
        ----------
        seconds, rudder
            As of `advance`.

        Raises
        ------
        ParameterError
            As from `advance`; for noise_scheme "per-step", which draws other noise for other steps;
            and for dt_s below 8e-6. The flock is unchanged then.
        SolverError
            As from `advance`.
        """
        return self._in_core.advance_with_error(seconds, rudder)

    def set_step(self, dt_s: float) -> None:
        """Change dt_s from now on.

        White noise stays the same function of time: copies of a flock meet the same noise whatever
        their steps, so that they differ by the error of the step alone. A new flock with another
        dt_s meets other noise.

        Parameters
        ----------
        dt_s
            As of `FlockParameters`. A ParameterError, which leaves the flock unchanged, refuses a
            step out of range.
        """
        self._in_core.set_step(dt_s)

    def steering_law(self) -> NDArray[np.float64]:
        """Return rudders of the paper's law, eq. (10), for where the leaders are now: (k,)."""
        return self._in_core.steering_law()

    def order_parameters(self, include_leaders: bool = False) -> OrderParameters:
        """Return the order parameters of the normal boats, or of all boats, now.

        If there is no such boat, this is a ParameterError.
        """
        every = as_bool(include_leaders, "include_leaders")
        return OrderParameters(*self._in_core.order_parameters(every))

    def contacts(self) -> Contacts:
        """Return contacts and near-contacts of the last substep; none if a state was set since."""
        return Contacts(**self._in_core.contacts())

    def snapshot(self) -> bytes:
        """Return the whole state; continuing from it is bit-identical on the same machine.

        Parameters are in it by name. Motion and noise belong to the build that wrote it.
        """
        return self._in_core.snapshot()

    def restore(self, snapshot: bytes, noise_seed: int | None = None) -> None:
        """Continue from a snapshot of a flock with the same parameters, the target aside.

        Parameters
        ----------
        snapshot
            Bytes of `snapshot`.
        noise_seed
            None: the noise of the snapshot, so that all flocks that continue from it meet the same
            noise. A whole number: other noise from here on, the same for every flock with this
            number, and never the noise of a flock with this `seed`.

        Raises
        ------
        ParameterError
            For bytes that are no whole, unharmed snapshot, for the snapshot of a flock with other
            parameters, and for a noise_seed out of range; the flock is unchanged then.
        TypeError
            For a noise_seed that is no whole number.
        """
        self._in_core.restore(as_bytes(snapshot, "snapshot"), noise_seed)

    def __copy__(self) -> Self:
        return self._from_core(self._in_core.copy())

    def __deepcopy__(self, memo: Any) -> Self:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_snapshot, (self.snapshot(),)

    def __repr__(self) -> str:
        boats, leaders = self.parameters.n_boats, self.parameters.n_leaders
        time_s = repr(self.time_s).removesuffix(".0")
        return (
            f"<flockenv.Flock of {boats} boats, {leaders} of them leaders, seed {self.seed}, "
            f"time {time_s} s>"
        )

    def _repr_html_(self) -> str:
        """Return the flock as a picture, for notebooks."""
        png = base64.b64encode(self._in_core.png(_NOTEBOOK_PIXELS)).decode("ascii")
        return f'<img alt="{repr(self).strip("<>")}" src="data:image/png;base64,{png}">'
