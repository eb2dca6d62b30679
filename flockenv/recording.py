"""Runs, sampled at a fixed rate: saved and loaded."""

import os
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.errors import ParameterError
from flockenv.flock import ContactSeries, Flock, OrderSeries
from flockenv.parameters import FlockParameters

__all__ = ["PHASES", "PRECISIONS", "Recording"]

_FORMAT = "flockenv recording 1"
PHASES = np.array(_core.phase_names())
_ORDER = tuple(each.name for each in fields(OrderSeries))
_CONTACTS = tuple(each.name for each in fields(ContactSeries))
_ARRAYS = ("time_s", "phase", "in_analysis_window", "pose", "velocity")
PRECISIONS = (np.dtype(np.float64), np.dtype(np.float32))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Recording:
    """A run sampled t times, of n boats; checked on construction.

    Attributes
    ----------
    time_s : float64 array, shape (t,)
        Times in s, increasing.
    phase : str array, shape (t,)
        The phase that begins or holds at each time: "fw", "nop1", "bw" or "nop2".
    in_analysis_window : bool array, shape (t,)
        Whether each time lies in the second half of fw or the first half of nop1 (Section 4).
    pose : float64 or float32 array, shape (t, n, 3)
        [x cm, y cm, heading rad counter-clockwise from x, not wrapped], leaders first.
    velocity : array of the same dtype, shape (t, n, 3)
        [cm/s, cm/s, rad/s]. With the leapfrog scheme these are means over the substep before.
    order : OrderSeries
        Order parameters of the normal boats; NaN only where they are undefined.
    parameters : FlockParameters
        What was run.
    seed : int
        Seed of all random streams.
    version : str
        Version of flockenv that ran it.
    contacts : ContactSeries or None
        Contacts that carried a force, if they were recorded.

    Raises
    ------
    ParameterError
        For arrays of a wrong shape or dtype, numbers that are not finite, unknown phases.
    """

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

    def __post_init__(self) -> None:
        times = np.shape(self.time_s)[:1]
        state = (*times, self.parameters.n_boats, 3)
        _check("time_s", self.time_s, times, PRECISIONS[:1])
        _check("phase", self.phase, times, (PHASES.dtype,))
        _check("in_analysis_window", self.in_analysis_window, times, (np.dtype(np.bool_),))
        _check("pose", self.pose, state, PRECISIONS)
        _check("velocity", self.velocity, state, (self.pose.dtype,))
        if not np.isin(self.phase, PHASES).all():
            raise ParameterError(f"phase holds other names than {', '.join(PHASES)}")
        if times == (0,) or not (np.diff(self.time_s) > 0).all() or self.time_s[0] < 0:
            raise ParameterError("time_s must hold at least one time, from 0 on, and increase")
        normal_boats = self.parameters.n_boats - self.parameters.n_leaders
        for name in _ORDER:
            values = getattr(self.order, name)
            undefined = normal_boats == 0 or (normal_boats == 1 and name in ("c_o", "c_v"))
            _check(f"order.{name}", values, times, PRECISIONS[:1], all_nan=undefined)
        seed: Any = self.seed
        if not isinstance(seed, int) or not 0 <= seed < 2**64:
            raise ParameterError(f"seed = {seed!r} is not accepted: an int from 0 to 2^64 - 1")
        if self.contacts is not None:
            self.contacts.check(len(self), self.parameters.n_boats)

    def __len__(self) -> int:
        return len(self.time_s)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Recording):
            return NotImplemented
        plain = ("order", "parameters", "seed", "version", "contacts")
        return all(getattr(self, name) == getattr(other, name) for name in plain) and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in _ARRAYS
        )

    def __repr__(self) -> str:
        return (
            f"<flockenv.Recording of {self.parameters.n_boats} boats, seed {self.seed}, "
            f"{len(self)} samples to {self.time_s[-1]} s>"
        )

    def flock_at(self, time_s: float) -> Flock:
        """Return the flock at the last sample up to a time, as far as it was recorded.

        Contacts and the state of the noise are no part of it: such a flock has the poses, the
        velocities and the time of the sample, and does not move on as the recorded one did.

        Raises
        ------
        ParameterError
            For a time outside the recording.
        """
        begin, end = self.time_s[0], self.time_s[-1]
        if not begin <= time_s <= end:
            raise ParameterError(
                f"time_s = {time_s!r} is not accepted: a time from {begin} to {end} s"
            )
        sample = int(np.searchsorted(self.time_s, time_s, side="right")) - 1
        state = {
            "pose": self.pose[sample].astype(np.float64),
            "velocity": self.velocity[sample].astype(np.float64),
            "time_s": float(self.time_s[sample]),
            # Single precision leaves overlaps of a rounding.
            "allow_overlap": True,
        }
        return Flock.from_state(self.parameters, self.seed, state)

    def save(self, path: str | os.PathLike[str], *, compressed: bool = False) -> None:
        """Write the recording to an ``.npz`` file, whole or not at all.

        Its arrays have the names of this class's attributes (``order_psi_o`` … for the order
        parameters, ``contacts_i`` … for contacts), the parameters are TOML. An hour of 20 boats at
        10 Hz takes 37 MB without contacts, or 20 MB in float32; compression saves little of that
        and takes seconds.

        Raises
        ------
        OSError
            If the file cannot be written; what was there before is still there.
        """
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= {f"order_{name}": getattr(self.order, name) for name in _ORDER}
        if self.contacts is not None:
            arrays |= {f"contacts_{name}": getattr(self.contacts, name) for name in _CONTACTS}
        texts = {
            "format": _FORMAT,
            "version": self.version,
            "parameters": self.parameters.to_toml(),
        }
        arrays |= {name: np.array(text) for name, text in texts.items()}
        arrays["seed"] = np.array(self.seed, np.uint64)
        write_arrays(path, arrays, compressed=compressed)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a recording; nothing in the file is ever executed.

        Raises
        ------
        OSError
            If the file cannot be opened.
        ParameterError
            If it is damaged, cut off, or no recording; the message names the file and the fault.
        """
        arrays = read_arrays(path)
        try:
            return cls._from_arrays(arrays)
        except (ParameterError, TypeError) as error:
            raise ParameterError(f"{path} is no recording of flockenv: {error}") from error

    @classmethod
    def _from_arrays(cls, arrays: dict[str, NDArray[Any]]) -> Self:
        texts = ("format", "version", "parameters")
        expected = {*_ARRAYS, *(f"order_{name}" for name in _ORDER), *texts, "seed"}
        with_contacts = {f"contacts_{name}" for name in _CONTACTS}
        has_contacts = not with_contacts.isdisjoint(arrays)
        expected |= with_contacts if has_contacts else set()
        if arrays.keys() != expected:
            different = ", ".join(sorted(arrays.keys() ^ expected))
            raise ParameterError(f"these arrays are missing or unknown: {different}")
        if any(arrays[name].ndim or arrays[name].dtype.kind != "U" for name in texts):
            raise ParameterError(f"{', '.join(texts)} must each be one string")
        _check("seed", arrays["seed"], (), (np.dtype(np.uint64),))
        form, version, parameters = (str(arrays[name]) for name in texts)
        if form != _FORMAT:
            raise ParameterError(f"format = {form!r} is not accepted: {_FORMAT!r}")
        return cls(
            **{name: arrays[name] for name in _ARRAYS},
            order=OrderSeries(*(arrays[f"order_{name}"] for name in _ORDER)),
            parameters=FlockParameters.from_toml(parameters),
            seed=int(arrays["seed"]),
            version=version,
            contacts=ContactSeries(*(arrays[f"contacts_{name}"] for name in _CONTACTS))
            if has_contacts
            else None,
        )


def _check(
    name: str,
    array: Any,
    shape: tuple[int, ...],
    dtypes: tuple[np.dtype[Any], ...],
    *,
    all_nan: bool = False,
) -> None:
    if not isinstance(array, np.ndarray) or array.dtype not in dtypes:
        found = array.dtype if isinstance(array, np.ndarray) else type(array).__name__
        raise ParameterError(f"{name} is of {found}, expected an array of {dtypes[0]}")
    if array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}, expected {shape}")
    if array.dtype.kind == "f" and not (np.isnan if all_nan else np.isfinite)(array).all():
        raise ParameterError(f"{name} must be {'undefined (NaN)' if all_nan else 'finite'}")
