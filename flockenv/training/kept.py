"""`Kept`: a run as it is between two rollouts, and the files that it is written to."""

import csv
import io
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from stable_baselines3 import PPO

from flockenv._io.atomic_write import atomic_write
from flockenv.policies import NetworkPolicy
from flockenv.training import checkpoint
from flockenv.training.checkpoint import Progress
from flockenv.training.settings import TrainingSettings

__all__ = ["Kept"]


@dataclass(frozen=True)
class Kept:
    """What a run can go on from, which nothing that comes next changes.

    Attributes
    ----------
    state
        What goes into the checkpoint.
    policy
        The mean policy; who writes it says in ``made`` what made it.
    progress
        How far the run was.
    """

    state: checkpoint.State
    policy: NetworkPolicy
    progress: Progress

    @classmethod
    def of(
        cls, model: PPO, settings: TrainingSettings, progress: Progress, policy: NetworkPolicy
    ) -> Self:
        """Return a run as it is now, between two rollouts."""
        state = checkpoint.state_of(model, settings, progress)
        return cls(state, policy, deepcopy(progress))

    def write(self, folder: Path) -> None:
        """Write ``last.npz``, ``curve.csv``, ``validations.csv`` and, last, ``checkpoint.npz``.

        Raises
        ------
        OSError
            If one cannot be written; each is whole or as it was before.
        """
        self.policy.save(folder / "last.npz")
        _write_rows(folder / "curve.csv", self.progress.curve)
        _write_rows(folder / "validations.csv", self.progress.validations)
        checkpoint.save(folder / "checkpoint.npz", self.state)


def _write_rows(path: Path, rows: list[dict[str, float]]) -> None:
    if rows:
        text = io.StringIO(newline="")
        writer = csv.DictWriter(text, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        with atomic_write(path) as file:
            file.write(text.getvalue().encode())
