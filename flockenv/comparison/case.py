"""A case of a comparison: one flock, its seeds and its options, in which policies are compared."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flockenv._io.arguments import items
from flockenv._io.extras import require
from flockenv.comparison.comparison import Finished, compare_leaders, nothing_finished
from flockenv.comparison.episodes import Progress, no_progress
from flockenv.parameters import FlockParameters
from flockenv.policies.registry import PolicyLike

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One flock in which policies are compared."""

    #: Name of the case, and of the file of its parameters.
    name: str
    #: Parameters of the flock, except for the number of leaders.
    parameters: FlockParameters
    #: Numbers of leaders.
    leaders: tuple[int, ...]
    #: Seeds, one episode each.
    seeds: Sequence[int]
    #: Length of an episode in s.
    episode_s: float = 480.0
    #: Options of the environment that differ from its defaults.
    environment: Mapping[str, object] = field(default_factory=dict)
    #: Targets that the seeds use in turn instead of the parameters' target. The signed order is
    #: towards the target of leader 0.
    targets: tuple[object, ...] = ()

    def __post_init__(self) -> None:
        for name in ("leaders", "seeds", "targets"):
            object.__setattr__(self, name, items(getattr(self, name), name))

    def flock_hours(self, policies: int) -> float:
        """Return the simulated hours of all flocks that this number of policies leads."""
        flocks = sum(policies if k > 0 else 1 for k in self.leaders) * len(self.seeds)
        return flocks * self.episode_s / 3600.0

    def run(
        self,
        policies: Mapping[str, PolicyLike | Mapping[str, PolicyLike]],
        progress: Progress = no_progress,
        finished: Finished = nothing_finished,
    ) -> "pd.DataFrame":
        """Run every policy; return the table of `compare_leaders` with a column ``case``.

        Calls `finished` with the rows of each policy and number of leaders when they are complete.
        Raises the errors of `compare_leaders`.
        """
        targets = self.targets or (self.parameters.target,)
        # `compare_leaders` refuses policies without leaders.
        steering = policies if any(self.leaders) else {}
        parts = [
            compare_leaders(
                self.parameters.replace(target=target),
                self.leaders,
                steering,
                self.seeds[index :: len(targets)],
                self.episode_s,
                progress,
                self.environment,
                lambda rows: finished(rows.assign(case=self.name)),
            )
            for index, target in enumerate(targets)
        ]
        runs: pd.DataFrame = require("pandas", "plot").concat(parts, ignore_index=True)
        runs.insert(0, "case", self.name)
        return runs

    def described(self) -> dict[str, object]:
        """Return the entries of `run.toml`: leaders, seeds, length, options of the environment."""
        return {
            "leaders": list(self.leaders),
            "seeds": {"first": self.seeds[0], "number": len(self.seeds)},
            "episode_s": self.episode_s,
            "environment": {"target": self.parameters.target, **self.environment},
        }

    def title(self) -> str:
        """Return the main parameters and the options in one line."""
        flock = self.parameters
        options = {"bw_s": flock.bw_s, "target": flock.target, **self.environment}
        parts = [f"{flock.n_boats} boats, pool {flock.pool}"]
        parts += [f"{name} = {value}" for name, value in options.items()]
        return ", ".join([*parts, f"{flock.scheme} + {flock.noise_scheme}"])
