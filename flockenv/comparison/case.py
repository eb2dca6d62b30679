"""A case of a comparison: one flock, its seeds and its options, in which policies are compared."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from flockenv._io.extras import require
from flockenv.comparison.episodes import Steering, compare_leaders
from flockenv.parameters import FlockParameters

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Case"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One flock in which policies are compared.

    Attributes
    ----------
    name : str
        Its name, which is that of its file of parameters.
    parameters : FlockParameters
        Of the flock, except for the number of leaders.
    leaders : tuple of int
        Numbers of leaders.
    seeds : sequence of int
        One episode each.
    episode_s : float
        Length of an episode in s.
    environment : dict
        Options of the environment that differ from its defaults.
    targets : tuple
        Targets that are dealt out to the seeds in turn, each as in the parameters; none: that of
        the parameters. The signed order counts towards the target of leader 0.
    meaning : str
        What it asks of leaders.
    """

    name: str
    parameters: FlockParameters
    leaders: tuple[int, ...]
    seeds: Sequence[int]
    episode_s: float = 480.0
    environment: Mapping[str, Any] = field(default_factory=dict)
    targets: tuple[Any, ...] = ()
    meaning: str = ""

    def flock_hours(self, policies: int) -> float:
        """Return the hours of simulated time that a number of policies takes."""
        flocks = sum(policies if k > 0 else 1 for k in self.leaders) * len(self.seeds)
        return flocks * self.episode_s / 3600.0

    def run(
        self,
        policies: Mapping[str, Steering],
        progress: Callable[[float], None] = lambda flock_seconds: None,
    ) -> "pd.DataFrame":
        """Run every policy; return a row per episode, as `compare_leaders` with a column ``case``.

        Errors are those of `compare_leaders`.
        """
        targets = self.targets or (self.parameters.target,)
        parts = []
        for place, target in enumerate(targets):
            parameters = self.parameters.replace(target=target)
            seeds = self.seeds[place :: len(targets)]
            options = self.environment
            parts.append(
                compare_leaders(
                    parameters, self.leaders, policies, seeds, self.episode_s, progress, options
                )
            )
        runs: pd.DataFrame = require("pandas", "plot").concat(parts, ignore_index=True)
        runs.insert(0, "case", self.name)
        return runs

    def title(self) -> str:
        """Return the parameters and the options in one line."""
        parameters, options = self.parameters, dict(self.environment)
        target = options.pop("target", parameters.target)
        dropped = options.pop("dropout_rate", 0.0)
        bw_s = options.pop("bw_s", None)
        parts = [
            f"{parameters.n_boats} boats",
            f"pool {parameters.pool}",
            f"bw = {parameters.bw_s:g} s" if bw_s is None else f"bw from {bw_s[0]} to {bw_s[1]} s",
            "alternating targets" if target == "alternate" else f"target {target}",
            *([f"{100 * dropped:.3g} % of positions dropped"] if dropped else []),
            *(f"{name} = {value}" for name, value in options.items()),
            f"{parameters.scheme} + {parameters.noise_scheme}",
        ]
        return ", ".join(parts)
