"""Runs as data: picklable specs, and the parts of a run that are stored."""

import hashlib
import json
from dataclasses import dataclass, fields, replace
from functools import cache

import numpy as np

from flockenv._io.arguments import as_float, as_int, number
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.order import ORDER, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.policies.base import Policy, Pool
from flockenv.policies.names import EVERY_SUBSTEP
from flockenv.policies.registry import NAMES, policy
from flockenv.recording import Recording
from flockenv.recording.checks import check_seed
from flockenv.simulation import simulate

_DEFAULTS = FlockParameters().to_dict()


@cache
def _named(name: str, pool: Pool) -> Policy:
    """Return the policy with a name; refuse a pool that it was not made for."""
    return policy(name, pool)


KEEP = ("window", "order", "poses")
"""Stored parts of a run. "window": order parameters of the samples in the analysis window after
the first tenth; "order": those of all samples; "poses": the latter and all poses and velocities."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSpec:
    """Everything on which the result of a run depends, hashable and picklable.

    Raises ParameterError for a value out of range, and for an unknown name.

    Attributes
    ----------
    parameters : FlockParameters
        Parameters of the flock.
    seed : int
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s : float
        Length of the run in s.
    sample_hz : float
        Samples per second.
    policy : str
        Name of a policy, such as "learned"; the paper's law at every substep by default.
    keep : str
        The parts of the run that are stored, one of `KEEP`.
    """

    parameters: FlockParameters
    seed: int
    duration_s: float
    sample_hz: float = 10.0
    policy: str = EVERY_SUBSTEP
    keep: str = "window"

    def __post_init__(self) -> None:
        if not isinstance(self.parameters, FlockParameters):
            raise TypeError(
                f"parameters must be FlockParameters, not {short_repr(self.parameters)}"
            )
        refuse_unknown((self.policy,), NAMES, "policy of a run")
        acts_at_decisions = _named(self.policy, self.parameters.pool).control_hz is not None
        if acts_at_decisions and self.parameters.n_leaders == 0:
            raise ParameterError(
                f"policy = {self.policy!r} is not accepted for n_leaders = 0: nobody is steered"
            )
        refuse_unknown((self.keep,), KEEP, "part of a run to keep")
        object.__setattr__(self, "seed", as_int(self.seed, "seed"))
        check_seed(self.seed)
        for name, most in (("duration_s", 1e9), ("sample_hz", 1e6)):
            value = as_float(number(getattr(self, name), name))
            if not 0.0 < value <= most:
                raise ParameterError(
                    f"{name} = {value!r} is not accepted: a positive number, at most {most:g}"
                )
            object.__setattr__(self, name, value)

    def to_json(self) -> str:
        """Return the spec as JSON; equal specs have equal text.

        Defaults are left out, so that a new field changes no run's text.
        """
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        changed = {f.name: values[f.name] for f in fields(self) if values[f.name] != f.default}
        parameters = dict(self.parameters.to_dict().items() - _DEFAULTS.items())
        text = json.dumps(changed | {"parameters": parameters}, sort_keys=True)
        # Adding 0.0 turns -0.0 into 0.0: they are equal, so they need the same text.
        return json.dumps(json.loads(text, parse_float=lambda number: float(number) + 0.0))

    @property
    def key(self) -> str:
        """SHA-256 of `to_json`, in 64 hexadecimal digits."""
        return hashlib.sha256(self.to_json().encode()).hexdigest()

    @property
    def checked_policy(self) -> Policy:
        """The policy that the spec names, for its pool, at the start of a run."""
        return _named(self.policy, self.parameters.pool).started()

    @property
    def cost(self) -> float:
        """A rough measure of the run's work: its duration in s times boats to the power 1.2."""
        return float(self.duration_s * self.parameters.n_boats**1.2)


def execute(spec: RunSpec) -> Recording:
    """Make a run. This is a pure function with the same bits in any thread, process and machine.

    Raises the errors of `simulate`.

    Returns
    -------
    Recording
        The parts that the spec keeps, in the precision of float32.
    """
    run = simulate(
        spec.parameters,
        spec.seed,
        spec.duration_s,
        spec.sample_hz,
        spec.checked_policy,
        dtype=np.float32,
    )
    # Rudders are not stored.
    run = replace(run, duration_s=spec.duration_s, rudder=None)
    if spec.keep == "window":
        run = run.analyzed()
    if spec.keep != "poses":
        run = run.without_poses()
    # Rounded to single precision, which the store compresses better; it rounds nothing itself.
    orders = {name: getattr(run.order, name).astype(np.float32) for name in ORDER}
    doubles = {name: values.astype(np.float64) for name, values in orders.items()}
    return replace(run, order=OrderSeries(**doubles))
