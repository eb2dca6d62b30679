"""Runs as data: what to run, a picklable spec, and what is kept of it."""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.flock import OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.recording import PHASES, Recording
from flockenv.runs.protocols.hysteresis import LOOPS, simulate_loop, simulate_prepared
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.runs.protocols.target_switching import simulate_alternating
from flockenv.simulation import simulate

__all__ = ["DISCARDED_SHARE", "KEEP", "ORDER_NAMES", "PROTOCOLS", "RunResult", "RunSpec", "execute"]

DISCARDED_SHARE = 0.1
"""The share of a run, at its start, that no figure uses."""

KEEP = ("window", "order", "poses")
"""What can be kept of a run: order parameters of the samples in the analysis window after the first
tenth; of all samples; or these and all poses and velocities."""

ORDER_NAMES = tuple(each.name for each in fields(OrderSeries))


def _law(spec: "RunSpec") -> Recording:
    return simulate(spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, dtype=np.float32)


def _alternating(spec: "RunSpec") -> Recording:
    return simulate_alternating(spec.parameters, spec.seed, spec.duration_s, spec.sample_hz)


def _loop(spec: "RunSpec") -> Recording:
    return simulate_loop(spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, spec.protocol)


def _prepared(spec: "RunSpec") -> Recording:
    return simulate_prepared(
        spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, spec.protocol
    )


PROTOCOLS: Mapping[str, Callable[["RunSpec"], Recording]] = {
    "law": _law,
    "alternating": _alternating,
    **dict.fromkeys(STARTS, _prepared),
    **dict.fromkeys(LOOPS, _loop),
}
"""Ways to make a run, by name. They live in this package, so that any worker process finds them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSpec:
    """One run to be made: hashable, picklable, and all that its result depends on.

    Attributes
    ----------
    parameters : FlockParameters
        The scene.
    seed : int
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s : float
        Length of the run in s.
    sample_hz : float
        Samples per second.
    protocol : str
        How leaders are led, a name in `PROTOCOLS`; "law": by eq. (10), towards the fixed target;
        "alternating": by eq. (10), towards directions that alternate every 4 minutes; the same as
        "law" from the starts of `runs.protocols.initial_state`; and the loops of
        `runs.protocols.hysteresis`.
    keep : str
        What is kept of the run, one of `KEEP`.

    Raises
    ------
    ParameterError
        For a value out of range or an unknown name.
    """

    parameters: FlockParameters
    seed: int
    duration_s: float
    sample_hz: float = 10.0
    protocol: str = "law"
    keep: str = "window"

    def __post_init__(self) -> None:
        for name, value, known in (
            ("protocol", self.protocol, PROTOCOLS),
            ("keep", self.keep, KEEP),
        ):
            if value not in known:
                raise ParameterError(f"{name} = {value!r} is not accepted: {', '.join(known)}")
        seed: Any = self.seed
        if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
            raise ParameterError(f"seed = {seed!r} is not accepted: an int from 0 to 2^64 - 1")
        for name in ("duration_s", "sample_hz"):
            object.__setattr__(self, name, float(getattr(self, name)))
            if not 0.0 < getattr(self, name) < math.inf:
                value = getattr(self, name)
                raise ParameterError(f"{name} = {value!r} is not accepted: a positive number")

    def to_json(self) -> str:
        """Return the spec as JSON with sorted keys: equal specs, equal text."""
        plain = {each.name: getattr(self, each.name) for each in fields(self)}
        plain["parameters"] = self.parameters.to_dict()
        return json.dumps(plain, sort_keys=True)

    @property
    def key(self) -> str:
        """SHA-256 of `to_json`, in 64 hexadecimal digits."""
        return hashlib.sha256(self.to_json().encode()).hexdigest()

    @property
    def cost(self) -> float:
        """A rough measure of the work it takes, for progress bars and for the order of starts."""
        return float(self.duration_s * self.parameters.n_boats**1.2)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RunResult:
    """What is kept of a run: t samples.

    Attributes
    ----------
    spec : RunSpec
        What was run.
    time_s : float64 array, shape (t,)
        Times in s.
    phase : uint8 array, shape (t,)
        Place of the phase in the cycle [fw, nop1, bw, nop2].
    in_analysis_window : bool array, shape (t,)
        Whether each time lies in the second half of fw or the first half of nop1 (Section 4).
    orders : dict of float32 arrays, shape (t,)
        Order parameters of the normal boats, under the names of `OrderSeries`.
    pose, velocity : float32 array, shape (t, n, 3), or None
        As in a `Recording`; None unless the spec keeps poses.
    """

    spec: RunSpec
    time_s: NDArray[np.float64]
    phase: NDArray[np.uint8]
    in_analysis_window: NDArray[np.bool_]
    orders: dict[str, NDArray[np.float32]]
    pose: NDArray[np.float32] | None = None
    velocity: NDArray[np.float32] | None = None

    @property
    def order(self) -> OrderSeries:
        """The order parameters as an `OrderSeries`."""
        return OrderSeries(*(self.orders[name].astype(np.float64) for name in ORDER_NAMES))

    @property
    def analyzed(self) -> NDArray[np.bool_]:
        """Bool array (t,): samples in the analysis window after the first tenth of the run."""
        return self.in_analysis_window & (self.time_s > DISCARDED_SHARE * self.spec.duration_s)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return all arrays by name, order parameters as ``order_<name>``."""
        arrays: dict[str, NDArray[Any]] = {
            "time_s": self.time_s,
            "phase": self.phase,
            "in_analysis_window": self.in_analysis_window,
            **{f"order_{name}": self.orders[name] for name in ORDER_NAMES},
        }
        if self.pose is not None and self.velocity is not None:
            arrays |= {"pose": self.pose, "velocity": self.velocity}
        return arrays

    @classmethod
    def from_arrays(cls, spec: RunSpec, arrays: Mapping[str, NDArray[Any]]) -> "RunResult":
        """Return the result that has these `arrays`.

        Raises
        ------
        ParameterError
            For missing, additional or misshapen arrays.
        """
        expected = _layout(spec, np.size(arrays.get("time_s", ())))
        found = {name: (array.shape, array.dtype) for name, array in arrays.items()}
        if found != expected:
            names = sorted(n for n in found.keys() | expected if found.get(n) != expected.get(n))
            raise ParameterError(f"these arrays are missing, unknown or misshapen: {names}")
        rest = {name: array for name, array in arrays.items() if not name.startswith("order_")}
        orders = {name: arrays[f"order_{name}"] for name in ORDER_NAMES}
        return cls(spec=spec, orders=orders, **rest)


def _layout(spec: RunSpec, samples: int) -> dict[str, tuple[tuple[int, ...], np.dtype[Any]]]:
    single = np.dtype(np.float32)
    layout: dict[str, tuple[tuple[int, ...], np.dtype[Any]]] = {
        **{f"order_{name}": ((samples,), single) for name in ORDER_NAMES},
        "time_s": ((samples,), np.dtype(np.float64)),
        "phase": ((samples,), np.dtype(np.uint8)),
        "in_analysis_window": ((samples,), np.dtype(np.bool_)),
    }
    if spec.keep == "poses":
        state = (samples, spec.parameters.n_boats, 3)
        layout |= {"pose": (state, single), "velocity": (state, single)}
    return layout


def execute(spec: RunSpec) -> RunResult:
    """Make a run: a pure function, the same bits in any thread or process of a machine.

    Raises
    ------
    FlockError
        As for `simulate`.
    """
    recording = PROTOCOLS[spec.protocol](spec)
    kept = np.ones(len(recording), np.bool_)
    if spec.keep == "window":
        late = recording.time_s > DISCARDED_SHARE * spec.duration_s
        kept = recording.in_analysis_window & late
    phase = (recording.phase[kept, None] == PHASES).argmax(axis=1).astype(np.uint8)
    order = {name: getattr(recording.order, name)[kept] for name in ORDER_NAMES}
    poses = spec.keep == "poses"
    return RunResult(
        spec=spec,
        time_s=recording.time_s[kept],
        phase=phase,
        in_analysis_window=recording.in_analysis_window[kept],
        orders={name: values.astype(np.float32) for name, values in order.items()},
        pose=recording.pose.astype(np.float32) if poses else None,
        velocity=recording.velocity.astype(np.float32) if poses else None,
    )
