"""Recordings: runs that are sampled at a fixed rate, saved and loaded."""

import html
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.arguments import as_bool, number
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.errors import HintsAtNames, ParameterError, short_repr
from flockenv.flock import ContactSeries, Flock, StepStatistics
from flockenv.order import OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.recording.checks import (
    MOTION_BOUNDS,
    ORIGIN,
    PHASES,
    PRECISIONS,
    check_array,
    check_contacts,
    check_ids,
    check_order,
    check_origin,
    check_seed,
    check_share,
    check_times,
)
from flockenv.recording.quantities import check_quantities, read_only, user_series
from flockenv.recording.stored import ARRAYS, LayoutError, arrays_of, fields_from
from flockenv.recording.tables import dataset_of, table_of

if TYPE_CHECKING:
    import pandas
    import xarray

DISCARDED_SHARE = 0.1
"""Fraction of a run, from its start, that no figure uses."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Recording(HintsAtNames):
    """A run of n boats with t samples; checked on construction.

    Attributes
    ----------
    time_s : float64 array, shape (t,)
        Times in s, increasing.
    phase : str array, shape (t,)
        The phase that starts or lasts at each time: "fw", "nop1", "bw" or "nop2".
    in_analysis_window : bool array, shape (t,)
        Whether each time lies in the second half of fw or the first half of nop1 (Section 4).
    pose : float64 or float32 array, shape (t, n, 3)
        [x cm, y cm, heading rad counter-clockwise from x, not wrapped], leaders first. Shape (t, 0,
        3) if poses were not kept.
    velocity : array of the same dtype and shape
        [cm/s, cm/s, rad/s]. With the leapfrog scheme these are means over the previous substep.
    order : OrderSeries
        Order parameters of the normal boats, with these times; NaN only where they are undefined.
    parameters : FlockParameters
        Parameters of the flock at the start of the run.
    seed : int
        Seed of all random streams.
    version : str
        Version of flockenv that ran it.
    rudder : float64 array, shape (t, k), or None
        Rudder commands of the leaders in [-1, 1]: eq. (10) at each pose under the law, otherwise
        the command that was held up to each time, 0 at the start. None if they were not recorded,
        as in stored runs of sweeps.
    contacts : ContactSeries or None
        Contacts that carried a force, if they were recorded.
    policy : str or None
        Name of what steered the leaders: "paper's law at every substep", or the policy's name; a
        learned policy's name ends in the first digits of its SHA-256. None if unknown, as for
        tracks.
    statistics : StepStatistics or None
        Worst overlap, unsolved and halved substeps of the flock at the end; None if they are
        unknown, as for tracks.
    duration_s : float
        End of the run in s from time 0, by default the time of the last sample. The samples may
        cover only a part of the run.
    quantities : dict of float64 arrays, shape (t,)
        User-defined quantities, by name; see `with_quantities`.
    noise_seed : int or None
        Seed of other noise after a snapshot; None for the noise of the snapshot, or of `seed`.
    control_hz : float or None
        Rate of decisions that was given for all policies; None if each used its own.
    start_sha256 : str or None
        Digest of the start: of the snapshot, or of pose, velocity and time of a state; None for a
        random start.
    schedule_sha256 : str or None
        Digest of the schedule (what changed, and when); None if `parameters` held throughout.
    ids : str array, shape (n,), or None
        Names of tracked boats, leaders first; None for a simulated flock. Only with names may rows
        of `pose` and `velocity` be NaN, for missing boats. Quantities of too few boats are then
        NaN, and `phase` may be "", which means unknown.

    Raises
    ------
    ParameterError
        For arrays of a wrong shape or dtype, numbers out of their range, unknown phases.
    """

    _meanings: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("position", "positions", "poses", "headings"), "'pose'"),
        **dict.fromkeys(("velocities", "speed", "speeds"), "'velocity'"),
        **dict.fromkeys(("time", "times", "t"), "'time_s'"),
        **dict.fromkeys(("actions", "rudders"), "'rudder'"),
        **dict.fromkeys(("psi_o", "psi_v", "phi_o", "phi_v", "psi"), "an entry of 'order'"),
        **dict.fromkeys(("bw_s", "n_boats", "n_leaders", "pool"), "an entry of 'parameters'"),
    }

    time_s: NDArray[np.float64]
    phase: NDArray[np.str_]
    in_analysis_window: NDArray[np.bool_]
    pose: NDArray[np.floating[Any]]
    velocity: NDArray[np.floating[Any]]
    order: OrderSeries
    parameters: FlockParameters
    seed: int
    version: str
    contacts: ContactSeries | None = None
    rudder: NDArray[np.float64] | None = None
    policy: str | None = None
    statistics: StepStatistics | None = None
    duration_s: float = math.nan
    quantities: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    ids: NDArray[np.str_] | None = None
    noise_seed: int | None = None
    control_hz: float | None = None
    start_sha256: str | None = None
    schedule_sha256: str | None = None

    def __post_init__(self) -> None:
        times = np.shape(self.time_s)[:1]
        with_poses = np.shape(self.pose)[1:2] != (0,)
        poses_shape = (*times, self.parameters.n_boats if with_poses else 0, 3)
        check_array("time_s", self.time_s, times, PRECISIONS[:1])
        check_array("phase", self.phase, times, (PHASES.dtype,))
        check_array("in_analysis_window", self.in_analysis_window, times, (np.dtype(np.bool_),))
        tracked = self.ids is not None
        allowed: dict[str, Any] = {"gaps": tracked, "bounds": MOTION_BOUNDS}
        check_array("pose", self.pose, poses_shape, PRECISIONS, **allowed)
        check_array("velocity", self.velocity, poses_shape, (self.pose.dtype,), **allowed)
        if self.ids is not None:
            check_ids(self.ids, self.parameters.n_boats)
        if not np.isin(self.phase, [*PHASES, ""] if tracked else PHASES).all():
            raise ParameterError(f"phase holds other names than {', '.join(PHASES)}")
        if math.isnan(self.duration_s) and len(self.time_s) > 0:
            object.__setattr__(self, "duration_s", float(self.time_s[-1]))
        check_times(self.time_s, self.duration_s)
        normal_boats = self.parameters.n_boats - self.parameters.n_leaders
        check_order(self.order, times, normal_boats, tracked=tracked, posed=with_poses)
        object.__setattr__(self, "order", self.order.at(slice(None), self.time_s))
        check_seed(self.seed)
        check_origin({name: getattr(self, name) for name in ORIGIN})
        check_quantities(self.quantities, times)
        if self.rudder is not None:
            check_array("rudder", self.rudder, (*times, self.parameters.n_leaders), PRECISIONS[:1])
            if (np.abs(self.rudder) > 1.0).any():
                raise ParameterError("rudder must be within [-1, 1]")
        if self.contacts is not None:
            check_contacts(self.contacts, len(self), self.parameters)

    def __len__(self) -> int:
        return len(self.time_s)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Recording):
            return NotImplemented
        arrays, others = arrays_of(self._fields()), arrays_of(other._fields())
        return arrays.keys() == others.keys() and all(
            np.array_equal(array, others[name], equal_nan=array.dtype.kind == "f")
            for name, array in arrays.items()
        )

    def __repr__(self) -> str:
        n = self.parameters.n_boats
        boats = f"{n} boats, seed {self.seed}" if self.ids is None else f"{n} tracked boats"
        return f"<flockenv.Recording of {boats}, {len(self)} samples to {self.duration_s} s>"

    def _fields(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def flock_at(self, time_s: float) -> Flock:
        """Return the flock at the last sample up to a time, as far as it was recorded.

        The flock has the poses, the velocities and the time of the sample. It lacks the contacts
        and the state of the noise, so it continues differently from the recorded flock. Raises the
        errors of `state_at`.
        """
        state = self.state_at(time_s)
        present = self._is_present(self._sample_at(time_s))
        leads, target = present[: self.parameters.n_leaders], self.parameters.target
        if isinstance(target, tuple):  # One per leader; a flock without leaders has no list.
            target = tuple(compress(target, leads)) or target[0]
        counts = {"n_boats": int(present.sum()), "n_leaders": int(leads.sum())}
        parameters = self.parameters.replace(**counts, target=target)
        return Flock.from_state(parameters, self.seed, state)

    def state_at(self, time_s: float) -> dict[str, Any]:
        """Return the state of the boats that are present at the last sample up to a time.

        Returns
        -------
        dict
            ``pose`` (n, 3), ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``, as
            `Flock.from_state`, ``simulate(start=...)`` and ``reset(options={"state": ...})`` take
            them.

        Raises
        ------
        ParameterError
            For a time outside the recording, and a recording without samples or poses.
        """
        sample = self._sample_at(time_s)
        present = self._is_present(sample)
        if not present.any():
            raise ParameterError(f"no boat is present at {short_repr(time_s)} s")
        return {
            "pose": self.pose[sample, present].astype(np.float64),
            "velocity": np.nan_to_num(self.velocity[sample, present].astype(np.float64)),
            "time_s": float(self.time_s[sample]),
            # Both single precision and cameras cause small overlaps.
            "allow_overlap": True,
        }

    def _sample_at(self, time_s: float) -> int:
        """Return the index of the last sample up to a time."""
        if len(self) == 0 or not self.has_poses:
            raise ParameterError("this recording holds no poses to make a flock of")
        start, end = self.time_s[0], self.time_s[-1]
        if not start <= number(time_s, "time_s") <= end:
            raise ParameterError(
                f"time_s = {short_repr(time_s)} is not accepted: a time from {start} to {end} s"
            )
        return int(np.searchsorted(self.time_s, time_s, side="right")) - 1

    def _is_present(self, sample: int) -> NDArray[np.bool_]:
        """Return for each boat whether it has a pose in a sample."""
        present: NDArray[np.bool_] = np.isfinite(self.pose[sample, :, 0])
        return present

    def to_dataframe(self, *, boats: bool = False) -> "pandas.DataFrame":
        """Return the recording as a table of pandas (extra ``plot``).

        Without pandas, a MissingExtraError says what to install.

        Parameters
        ----------
        boats
            False: one row per sample, with its time, phase and order parameters. True: one row per
            sample and present boat, with the boat's pose and velocity.

        Returns
        -------
        pandas.DataFrame
            Columns ``time_s``, ``phase``, ``in_analysis_window``, then the order parameters and the
            user-defined quantities. With ``boats``: ``boat``, ``is_leader``, ``id`` (of tracked
            boats), ``x_cm``, ``y_cm``, ``heading_rad``, ``velocity_x_cm_s``, ``velocity_y_cm_s``
            and ``angular_velocity_rad_s``.
        """
        return table_of(self, as_bool(boats, "boats"))

    def to_xarray(self) -> "xarray.Dataset":
        """Return the recording as a dataset of xarray (extra ``sweep``).

        Without xarray, a MissingExtraError says what to install.

        Returns
        -------
        xarray.Dataset
            Dimensions ``time_s`` and ``boat``. Variables: the phase, the analysis window and the
            order parameters by time; ``x_cm``, ``y_cm``, ``heading_rad``, ``velocity_x_cm_s``,
            ``velocity_y_cm_s`` and ``angular_velocity_rad_s`` by time and boat. Coordinate
            ``is_leader`` by boat, and ``id`` of tracked boats. Numbers have an attribute ``units``.
            Attributes: ``seed``, ``version``, and ``parameters`` as TOML; ``policy``,
            ``noise_seed``, ``control_hz``, ``start_sha256`` and ``schedule_sha256`` if the
            recording has them.
        """
        return dataset_of(self)

    def _repr_html_(self) -> str:
        """Return the last sample as a picture, for notebooks; the text if it has no boats."""
        words = html.escape(repr(self))
        try:
            picture = self.flock_at(float(self.time_s[-1]))._repr_html_()
        except (ParameterError, IndexError):
            return f"<code>{words}</code>"
        return f"{picture}<br><code>{words}</code>"

    @property
    def has_poses(self) -> bool:
        """Whether poses and velocities were kept."""
        return bool(self.pose.shape[1] > 0)

    def analyzed(self, after: float = DISCARDED_SHARE) -> Self:
        """Return the samples that figures use: those in the analysis window of a stationary flock.

        Parameters
        ----------
        after
            Fraction of the run, from its start, that is not used.

        Returns
        -------
        Recording
            Samples within the second half of fw or the first half of nop1 (Section 4), later than
            `after` times `duration_s`; possibly none.
        """
        check_share(after)
        return self._at(self.in_analysis_window & (self.time_s > after * self.duration_s))

    def with_quantities(self, functions: Mapping[str, Callable[[Self], ArrayLike]]) -> Self:
        """Return the recording with user-defined quantities, kept in `quantities`.

        Parameters
        ----------
        functions
            Functions by name. Each takes the recording, with read-only arrays, and returns a real
            number for each sample, shape (t,), or NaN if it is undefined.

        Raises
        ------
        ParameterError
            For functions that fail, for results that have a wrong shape or are not real numbers,
            and for names that are taken or are not identifiers. The error's attribute ``recording``
            is this recording.
        """
        try:
            series = user_series(functions, replace(self, **read_only(self._fields())))
            return replace(self, quantities={**self.quantities, **series})
        except ParameterError as error:
            vars(error)["recording"] = self
            raise

    def without_poses(self) -> Self:
        """Return the recording without its poses and velocities."""
        return replace(self, pose=self.pose[:, :0], velocity=self.velocity[:, :0])

    def _at(self, samples: NDArray[np.bool_]) -> Self:
        """Return the recording with only the selected samples."""
        selected: dict[str, Any] = {name: getattr(self, name)[samples] for name in ARRAYS}
        order = self.order.at(samples)
        contacts = None if self.contacts is None else self.contacts.at(samples)
        rudder = None if self.rudder is None else self.rudder[samples]
        quantities = {name: values[samples] for name, values in self.quantities.items()}
        selected |= {"order": order, "contacts": contacts, "rudder": rudder}
        return replace(self, **selected, quantities=quantities)

    def save(self, path: str | os.PathLike[str], *, compressed: bool = False) -> None:
        """Write the recording to an ``.npz`` file, completely or not at all.

        Its arrays have the names of this class's attributes (``order_psi_o`` … for the order
        parameters, ``contacts_i`` … for contacts), the parameters are TOML. An hour of 20 boats at
        10 Hz takes 37 MB without contacts, or 20 MB in float32; compression saves little of that
        and takes seconds.

        Raises
        ------
        ParameterError
            For a name that does not end in ``.npz``.
        OSError
            If the file cannot be written; an existing file is then unchanged.
        """
        if Path(path).suffix.lower() != ".npz":
            raise ParameterError(
                f"path = {os.fspath(path)!r} is not accepted: a name that ends in .npz; "
                "to_dataframe() has to_csv(), to_parquet() and others"
            )
        write_arrays(path, arrays_of(self._fields()), compressed=as_bool(compressed, "compressed"))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a recording; nothing in the file is ever executed.

        A quantity that the file lacks is computed from the poses. Without poses the quantity is
        NaN, with a `RecordingWarning`. Arrays and parameters that this flockenv does not know are
        dropped, with a warning, too.

        Raises
        ------
        OSError
            If the file cannot be opened.
        ParameterError
            If it is damaged, cut off, or no recording; the message names the file and the fault.
        """
        arrays = read_arrays(path)
        try:
            return cls(**fields_from(arrays))
        except (ParameterError, TypeError) as error:
            kind = LayoutError if isinstance(error, LayoutError) else ParameterError
            raise kind(f"{path} is not a recording of flockenv: {error}") from error
