"""Runs as data: what to run, a picklable spec, and what is stored of it."""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from flockenv.errors import ParameterError, shown
from flockenv.order import ORDER, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.policies.registry import POOL_POLICIES
from flockenv.recording import Recording
from flockenv.runs.protocols.hysteresis import LOOPS, simulate_loop, simulate_prepared
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.runs.protocols.target_switching import simulate_alternating
from flockenv.simulation import simulate

__all__ = ["KEEP", "PROTOCOLS", "RunSpec", "execute"]

KEEP = ("window", "order", "poses")
"""What can be stored of a run: order parameters of the samples in the analysis window after the
first tenth; of all samples; or these and all poses and velocities."""


def _simulated(spec: "RunSpec") -> Recording:
    policy = None if spec.protocol == "law" else spec.protocol
    return simulate(
        spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, policy, dtype=np.float32
    )


def _alternating(spec: "RunSpec") -> Recording:
    return simulate_alternating(spec.parameters, spec.seed, spec.duration_s, spec.sample_hz)


def _loop(spec: "RunSpec") -> Recording:
    return simulate_loop(spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, spec.protocol)


def _prepared(spec: "RunSpec") -> Recording:
    return simulate_prepared(
        spec.parameters, spec.seed, spec.duration_s, spec.sample_hz, spec.protocol
    )


PROTOCOLS: Mapping[str, Callable[["RunSpec"], Recording]] = {
    "law": _simulated,
    "alternating": _alternating,
    **dict.fromkeys(STARTS, _prepared),
    **dict.fromkeys(LOOPS, _loop),
    **dict.fromkeys(POOL_POLICIES, _simulated),
}
"""Ways to make a run, by name. They live in this package, so that any worker process finds them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSpec:
    """One run to be made: hashable, picklable, and all that its result depends on.

    Attributes
    ----------
    parameters : FlockParameters
        Of the flock.
    seed : int
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s : float
        Length of the run in s.
    sample_hz : float
        Samples per second.
    protocol : str
        How leaders are led, a name in `PROTOCOLS`; "law": by eq. (10), towards the fixed target;
        "alternating": by eq. (10), towards directions that alternate every 4 minutes; the same as
        "law" from the starts of `runs.protocols.initial_state`; the loops of
        `runs.protocols.hysteresis`; and policies made for the run's pool, such as "learned".
    keep : str
        What is stored of the run, one of `KEEP`.

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
            raise ParameterError(f"seed = {shown(seed)} is not accepted: an int from 0 to 2^64 - 1")
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
    def draws_seed(self) -> int:
        """A seed for draws from the run: the same for equal specs, and hardly for other ones."""
        return int(self.key[:8], 16)

    @property
    def cost(self) -> float:
        """A rough measure of the work it takes, for progress bars and for the order of starts."""
        return float(self.duration_s * self.parameters.n_boats**1.2)


def execute(spec: RunSpec) -> Recording:
    """Make a run: a pure function, the same bits in any thread, process and machine.

    Returns
    -------
    Recording
        What the spec keeps, in the precision of float32.

    Raises
    ------
    FlockError
        As for `simulate`.
    """
    # What the law commands follows from the poses.
    run = replace(PROTOCOLS[spec.protocol](spec), duration_s=spec.duration_s, rudder=None)
    if spec.keep == "window":
        run = run.analyzed()
    if spec.keep != "poses":
        run = run.without_poses()
    # A store holds no more digits, and a run from it is the same as a run made now.
    orders = {name: getattr(run.order, name).astype(np.float32) for name in ORDER}
    doubles = {name: values.astype(np.float64) for name, values in orders.items()}
    return replace(run, order=OrderSeries(**doubles))
