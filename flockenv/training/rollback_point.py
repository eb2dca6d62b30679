"""`RollbackPoint`: training between two rollouts, and the files that it is written to."""

import csv
import io
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from flockenv._io.atomic_write import atomic_write
from flockenv.policies import NetworkPolicy
from flockenv.training import checkpoint
from flockenv.training.checkpoint import Progress
from flockenv.training.learner import Learner
from flockenv.training.settings import TrainingSettings

__all__ = ["RollbackPoint", "with_flock_hours"]


@dataclass(frozen=True)
class RollbackPoint:
    """The state of training between two rollouts, which later training does not change.

    Attributes
    ----------
    state
        The contents of the checkpoint.
    policy
        The mean policy; its writer adds the provenance in ``made``.
    progress
        The progress of the run.
    settings
        The settings of the run.
    """

    state: checkpoint.State
    policy: NetworkPolicy
    progress: Progress
    settings: TrainingSettings

    @classmethod
    def of(
        cls, model: Learner, settings: TrainingSettings, progress: Progress, policy: NetworkPolicy
    ) -> Self:
        """Return the present state of training, between two rollouts."""
        state = checkpoint.state_of(model, settings, progress)
        return cls(state, policy, deepcopy(progress), settings)

    def write(self, folder: Path) -> None:
        """Write ``last.npz``, ``curve.csv``, ``validations.csv`` and, last, ``checkpoint.npz``.

        Raises
        ------
        OSError
            If one cannot be written; each is whole or as it was before.
        """
        self.policy.save(folder / "last.npz")
        _write_rows(folder / "curve.csv", with_flock_hours(self.progress.curve, self.settings))
        rows = with_flock_hours(self.progress.validations, self.settings)
        _write_rows(folder / "validations.csv", rows)
        checkpoint.save(folder / "checkpoint.npz", self.state)


def with_flock_hours(
    rows: list[dict[str, float]], settings: TrainingSettings
) -> list[dict[str, float]]:
    """Return the rows of a curve with the time simulated so far beside the samples."""
    timed = []
    for row in rows:
        hours = float(f"{settings.flock_hours_at(int(row['samples'])):.6g}")
        timed.append({"samples": row["samples"], "flock_hours": hours, **row})
    return timed


def _write_rows(path: Path, rows: list[dict[str, float]]) -> None:
    if rows:
        text = io.StringIO(newline="")
        writer = csv.DictWriter(text, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        with atomic_write(path) as file:
            file.write(text.getvalue().encode())
