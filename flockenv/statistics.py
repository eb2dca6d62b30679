"""What a flock's substeps did."""

from dataclasses import dataclass

__all__ = ["Statistics"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Statistics:
    """Running totals and worst cases since the flock was made or reset; snapshots carry them.

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
        Solves whose constraints contradicted each other or that missed their residual.
    recovery_passes : int
        Passes that moved deeply overlapping hulls apart.
    neighbor_builds : int
        Times a substep had to build the neighbour list anew.
    worst_residual_cm_s : float
        Largest natural residual of a solve in cm/s.
    worst_overlap_cm : float
        Deepest overlap at the beginning of a substep in cm, positive.
    """

    substeps: int
    solves: int
    contacts: int
    islands: int
    solver_iterations: int
    factored_rows: int
    most_factor_entries: int
    unsolved: int
    recovery_passes: int
    neighbor_builds: int
    worst_residual_cm_s: float
    worst_overlap_cm: float
