"""A flock that a program advances, with its contacts, order parameters and statistics."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import as_bool, as_bytes, materialized
from flockenv.errors import HintsAtNames
from flockenv.flock.contacts import Contacts
from flockenv.flock.statistics import Statistics
from flockenv.order import OrderParameters
from flockenv.parameters import FlockParameters

_NOTEBOOK_PIXELS = 400


class Flock(HintsAtNames):
    """A flock of boats in a pool.

    Boats start at rest, placed at random without overlap. Leaders are boats 0 to
    ``n_leaders - 1``. The same parameters and seed give the same bits on one machine, through
    snapshots, pickles and copies too. The interpreter lock is released while the flock moves.

    Parameters
    ----------
    parameters : FlockParameters
        Parameters of the flock.
    seed : int
        Seed of all random streams, 0 to 2^64 - 1.

    Raises
    ------
    ParameterError
        If the boats do not fit the pool, and for a seed out of range.
    InUseError
        From every method and attribute, while another thread runs a method of the flock.
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

        Raises ParameterError for bytes that are not a complete, undamaged snapshot.
        """
        return cls._from_core(_core.Flock.from_snapshot(as_bytes(snapshot, "snapshot"), noise_seed))

    @classmethod
    def from_state(cls, parameters: FlockParameters, seed: int, state: Mapping[str, Any]) -> Self:
        """Return a flock in a given state.

        Parameters
        ----------
        parameters, seed
            As for the class.
        state
            ``pose`` (n, 3) and, optionally, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``,
            as in `set_state`, whose errors this raises. Other keys are refused.
        """
        return cls._from_core(_core.Flock.from_state(parameters, seed, state))

    def reset(self, seed: int) -> None:
        """Start over with another seed, as a new flock with these parameters.

        Raises ParameterError if the boats do not fit the pool; the flock is unchanged then.
        """
        self._in_core.reset(seed)

    @property
    def parameters(self) -> FlockParameters:
        """The parameters, with the present target."""
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
    def current_cm_s(self) -> float:
        """Speed of the water's current in cm/s, counter-clockwise positive (Section 4.5).

        Its time is that of `velocity`. Water with inertia (``current_relaxation_s``) is at rest
        after `set_state`.
        """
        return self._in_core.current_cm_s

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
        """Sums and worst cases of the substeps since the flock was made or reset."""
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
            Accept hulls that overlap each other or a wall by more than a hundredth of their radius,
            which is more than contacts leave. The next substeps move them apart.

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
        """Change the direction that the paper's law steers leaders in.

        Parameters
        ----------
        target
            "cw" or "ccw", or a list with one per leader.

        Raises
        ------
        ParameterError
            For another name, and for a list of another length; the flock is unchanged then.
        """
        self._in_core.set_target(materialized(target))

    def advance(self, seconds: float, rudder: ArrayLike | None = None) -> None:
        """Advance by a duration.

        Substeps end on multiples of dt_s, on phase switches and at the end.

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
            If a pose or velocity exceeds 1e9 (cm, cm/s, rad, rad/s); the flock is then as before
            the call.
        """
        self._in_core.advance(seconds, rudder)

    def advance_with_error(self, seconds: float, rudder: ArrayLike | None = None) -> float:
        """Advance as `advance` does, and return the error in cm that the finite dt_s caused.

        The error is the distance from a run with substeps of dt_s / 8 from the same start, with the
        same noise: the root mean square over boats of ``|Δx|² + ρ²Δα²``, with the radius of
        gyration ρ. The call takes nine times as long as `advance`. The error of two advances
        together is not the sum of their errors.

        Parameters
        ----------
        seconds, rudder
            As for `advance`.

        Raises
        ------
        ParameterError
            As for `advance`; also for noise_scheme "per-step", whose noise depends on the step, and
            for dt_s below 8e-6. The flock is unchanged then.
        SolverError
            As for `advance`.
        """
        return self._in_core.advance_with_error(seconds, rudder)

    def set_step(self, dt_s: float) -> None:
        """Change dt_s from now on.

        White noise stays the same function of time: copies of a flock with different steps get the
        same noise, so they differ only by the error of the step. A new flock with another dt_s gets
        other noise.

        To measure the error of a shorter step, advance by half a second first: the longer step left
        overlaps of up to tolerance_cm, and opening them in a short substep pushes boats apart.

        Parameters
        ----------
        dt_s
            As for `FlockParameters`.

        Raises
        ------
        ParameterError
            For a step out of range; the flock is unchanged then.
        """
        self._in_core.set_step(dt_s)

    def steering_law(self) -> NDArray[np.float64]:
        """Return rudders of the paper's law, eq. (10), for the leaders' present poses: (k,)."""
        return self._in_core.steering_law()

    def order_parameters(self, include_leaders: bool = False) -> OrderParameters:
        """Return the order parameters of the normal boats, or of all boats, now.

        Raises ParameterError if there is no such boat.
        """
        of_all_boats = as_bool(include_leaders, "include_leaders")
        return OrderParameters(*self._in_core.order_parameters(of_all_boats))

    def contacts(self) -> Contacts:
        """Return contacts and near-contacts of the last substep.

        There are none after a state was set or restored, or an advance failed.
        """
        return Contacts(**self._in_core.contacts())

    def snapshot(self) -> bytes:
        """Return the whole state; continuing from it is bit-identical on the same machine.

        Parameters are stored by name. Motion and noise can be read only by the build that wrote
        them.
        """
        return self._in_core.snapshot()

    def restore(self, snapshot: bytes, noise_seed: int | None = None) -> None:
        """Continue from a snapshot of a flock with the same parameters; only the target may differ.

        Parameters
        ----------
        snapshot
            Bytes of `snapshot`.
        noise_seed
            None continues with the noise of the snapshot, the same for all flocks that continue
            from it. A whole number gives other noise from here on: the same for every flock with
            this number, but not that of a flock whose `seed` is this number.

        Raises
        ------
        ParameterError
            For bytes that are not a complete, undamaged snapshot, for the snapshot of a flock with
            other parameters, and for a noise_seed out of range; the flock is unchanged then.
        TypeError
            For a noise_seed that is not a whole number.
        """
        self._in_core.restore(as_bytes(snapshot, "snapshot"), noise_seed)

    def __copy__(self) -> Self:
        return self._from_core(self._in_core.copy())

    def __deepcopy__(self, memo: object) -> Self:
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
