"""What the environment classes share: one batch of flocks in the core, its seeds and its infos."""

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.envs.observation import flock_feature_space, state_space
from flockenv.envs.options import EnvOptions, known_reset_options
from flockenv.envs.reward import TERMS
from flockenv.errors import ParameterError, shown

__all__ = ["LeaderBatch", "at_least_one", "drawn_seed", "seeds_from"]

_SEEDS = 2**64
# More would fill the memory before anything is simulated.
_MOST = 100_000


class LeaderBatch:
    """A batch of flocks with their episodes. Rows are leaders, flock after flock."""

    def __init__(self, options: EnvOptions, leaders: Sequence[int], autoreset_mode: str) -> None:
        by_count = {k: options.parameters.replace(n_leaders=k) for k in set(leaders)}
        members = [by_count[k] for k in leaders]
        self.core = _core.EnvBatch(members, {**options.settings, "autoreset_mode": autoreset_mode})
        self.settings: dict[str, Any] = self.core.options
        self.num_flocks = len(members)
        self.leaders = tuple(leaders)
        self.observation_size: int = self.core.observation_size
        self.state_space = state_space(options.parameters.n_boats)
        self.flock_feature_space = flock_feature_space()
        #: Control steps from one decision to the next, and decisions per second.
        self.period_steps: int = self.core.period_steps
        self.decisions_hz: float = self.settings["control_hz"] / self.period_steps

    def reset(
        self,
        seeds: Sequence[int | None],
        options: Mapping[str, Any] | None,
        new_seed: Callable[[], int],
        mask: NDArray[np.bool_] | None = None,
    ) -> None:
        """Start episodes; `new_seed` gives flocks a seed that have never had one."""
        per_flock = self._per_flock(known_reset_options(options))
        chosen = np.ones(self.num_flocks, np.bool_) if mask is None else mask
        requests: list[dict[str, Any] | None] = [None] * self.num_flocks
        for flock in np.flatnonzero(chosen).tolist():
            seed = seeds[flock]
            if seed is None and not self.core.is_seeded(flock):
                seed = new_seed()
            requests[flock] = {**per_flock[flock], "seed": seed}
        self.core.reset(requests)

    def _per_flock(self, options: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Options for each flock: lists have one entry per flock, anything else holds for all."""
        per_flock: list[dict[str, Any]] = [{} for _ in range(self.num_flocks)]
        for name, value in options.items():
            values = value if isinstance(value, list) else [value] * self.num_flocks
            if len(values) != self.num_flocks:
                raise ParameterError(
                    f"reset option {name!r} lists {len(values)} values, expected {self.num_flocks}"
                )
            for own, each in zip(per_flock, values, strict=True):
                own[name] = each
        return per_flock

    def reset_info(self, flock: int) -> dict[str, Any]:
        """Return the infos of the start of an episode."""
        episode = self.core.episode(flock)
        seed = np.uint64(episode["flock_seed"])
        return {"target": episode["target"], "bw_s": episode["bw_s"], "flock_seed": seed}

    def end_info(self, flock: int) -> dict[str, Any]:
        """Return the infos of the end of an episode."""
        summary = self.core.finished(flock)
        if summary is None:
            return {}
        return {"episode_summary": {**summary, "flock_seed": np.uint64(summary["flock_seed"])}}

    def reward_terms(self) -> dict[str, NDArray[np.float64]]:
        """Return each term of the last step's reward, one number per row."""
        return dict(zip(TERMS, self.core.reward_terms(), strict=True))


def drawn_seed(random: np.random.Generator) -> int:
    """Draw a seed for an environment that was given none."""
    return int(random.integers(_SEEDS // 2))


def at_least_one(count: Any, name: str) -> int:
    """Return a count of flocks or leaders as an int, or raise the error that names it."""
    number = _whole(count, name)
    if not 1 <= number <= _MOST:
        raise ParameterError(f"{name} = {shown(number)} is not accepted: 1 to {_MOST}")
    return number


def seeds_from(first: Any, flocks: int) -> list[int]:
    """Return the seeds of flocks where the first one has this seed: each has the next."""
    if isinstance(first, float):
        # As the core says it for a single flock.
        raise ParameterError(f"seed = {first!r} is not accepted: a whole number")
    number = _whole(first, "seed")
    if not 0 <= number <= _SEEDS - flocks:
        raise ParameterError(
            f"seed = {shown(number)} is not accepted: at least 0, and below 2^64 for the last of "
            f"{flocks} flocks"
        )
    return [number + flock for flock in range(flocks)]


def _whole(value: Any, name: str) -> int:
    # As the core takes whole numbers: also NumPy's, and arrays of one without a dimension.
    try:
        if not isinstance(value, bool | np.bool_):
            return operator.index(value)
    except TypeError:
        pass
    kind = type(value).__name__
    raise TypeError(f"{name} must be an integer, not {shown(value)} of type {kind}")
