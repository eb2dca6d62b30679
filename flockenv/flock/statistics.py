"""Statistics of a flock's substeps: sums and worst cases."""

import math
from dataclasses import dataclass, fields

from flockenv.errors import ParameterError


@dataclass(frozen=True, kw_only=True)
class Statistics:
    """Running sums and worst cases since the flock was made or reset; snapshots include them.

    Attributes
    ----------
    substeps : int
        Substeps taken.
    solves : int
        Contact problems solved; substeps without a contact have none.
    contacts : int
        Contacts and near-contacts, summed over substeps.
    islands : int
        Islands (boats joined by contacts), summed over solves.
    solver_iterations : int
        Solver iterations, summed over solves and islands.
    factored_rows : int
        Rows of Cholesky factors computed.
    most_factor_entries : int
        Most numbers that the Cholesky factors of one solve held.
    unsolved : int
        Substeps that left overlaps deeper than the tolerance.
    halved_substeps : int
        Halvings of substeps. The reasons are overlaps deeper than the tolerance at the end of a
        substep, contacts that would have driven boats or took too much work, and boats that
        moved too far.
    depenetration_passes : int
        Passes that moved deeply overlapping hulls apart.
    neighbor_builds : int
        Rebuilds of the neighbor list in substeps; a substep may need several.
    worst_residual_cm_s : float
        Largest natural residual of a solve in cm/s.
    worst_overlap_cm : float
        Deepest overlap at the start of a substep in cm, positive.
    displaced_angular_momentum_cm2_s : float
        Sum of the absolute changes of the angular momentum about the pool's center, in cm²/s for
        boats of mass 1, when deeply overlapping hulls were moved apart.
    worst_error_cm : float
        Largest error that `Flock.advance_with_error` returned, in cm; 0 if it was not called.
    """

    substeps: int
    solves: int
    contacts: int
    islands: int
    solver_iterations: int
    factored_rows: int
    most_factor_entries: int
    unsolved: int
    halved_substeps: int
    depenetration_passes: int
    neighbor_builds: int
    worst_residual_cm_s: float
    worst_overlap_cm: float
    displaced_angular_momentum_cm2_s: float
    worst_error_cm: float


@dataclass(frozen=True, kw_only=True)
class StepStatistics:
    """The fields of `Statistics` that say whether a run kept its tolerance.

    Attributes
    ----------
    worst_overlap_cm : float
        Deepest overlap at the start of a substep in cm, positive.
    unsolved : int
        Substeps that left overlaps deeper than the tolerance.
    halved_substeps : int
        Halvings of substeps.
    """

    worst_overlap_cm: float
    unsolved: int
    halved_substeps: int

    def __post_init__(self) -> None:
        for statistic in fields(self):
            value = getattr(self, statistic.name)
            if not (math.isfinite(value) and value >= 0):
                raise ParameterError(f"{statistic.name} = {value} is not accepted: at least 0")


STEP_STATISTICS = tuple(statistic.name for statistic in fields(StepStatistics))
"""Names of the `StepStatistics`, as in tables and summaries of episodes."""
