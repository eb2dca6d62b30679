"""The critical noise, at which a flock loses its order as the noise rises."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.arguments import items, series
from flockenv.errors import ParameterError
from flockenv.statistics.intervals import bootstrap_interval

LEAST_ROTATION = 0.5
"""Mean ``|m|`` that a flock must reach at some noise; otherwise it has no order to lose."""

_FEWEST_RUNS = 3


def critical_noise(
    noise: ArrayLike, runs: Sequence[ArrayLike], seed: int = 0
) -> tuple[float, float, float]:
    """Return the noise at which a flock loses its order, with its interval at level `CONFIDENCE`.

    See `loss_of_order` for the rule. The bootstrap draws runs at each noise separately.

    Parameters
    ----------
    noise
        Shape (levels,), rising, such as ``bw_s`` in s. At the last level the flock is disordered.
    runs
        For each level an array of shape (runs, 2): a run's means of Ψ_o and of the rotation's size
        ``|m| = |Ψ_o sin φ_o|``, over the analysis window.
    seed
        Seed of the bootstrap.

    Returns
    -------
    tuple of float
        The noise and both ends of its interval. All are NaN if a level has fewer than three runs,
        if a mean is NaN, or if mean ``|m|`` is below `LEAST_ROTATION` at every noise: such a flock
        is jammed or disordered, and has no order to lose.

    Raises
    ------
    ParameterError
        If the noise does not rise, or runs and levels do not fit together.
    """
    levels = series(noise, "noise")
    groups = [np.asarray(group, float) for group in items(runs, "runs")]
    if len(levels) < 2 or not (np.diff(levels) > 0.0).all():
        raise ParameterError("noise: at least two levels, each above the one before")
    if len(groups) != len(levels) or any(g.ndim != 2 or g.shape[1] != 2 for g in groups):
        raise ParameterError(
            f"runs: expected {len(levels)} arrays, one per level, of shape (runs, 2): Ψ_o and |m|"
        )
    unknown = math.nan, math.nan, math.nan
    if min(map(len, groups)) < _FEWEST_RUNS or np.isnan(np.concatenate(groups)).any():
        return unknown
    if max(group[:, 1].mean() for group in groups) < LEAST_ROTATION:
        return unknown

    def noise_of_drawn_runs(*indices: object, axis: int) -> NDArray[np.float64]:
        """Return the critical noise of drawn runs.

        `indices` holds an array of runs' indices for each level. Means are over its last axis, as
        the bootstrap asks with `axis`.
        """
        drawn = [
            group[np.asarray(level_indices, int)]
            for group, level_indices in zip(groups, indices, strict=True)
        ]
        # To be stacked, all levels need the same leading axes, which count resamples.
        psi_o, rotation = (
            np.stack(np.broadcast_arrays(*(level[..., column].mean(-1) for level in drawn)))
            for column in (0, 1)
        )
        return loss_of_order(levels, psi_o, rotation)

    run_indices = [np.arange(len(group)) for group in groups]
    return bootstrap_interval(run_indices, noise_of_drawn_runs, seed, paired=False)


def loss_of_order(noise: ArrayLike, psi_o: ArrayLike, rotation: ArrayLike) -> NDArray[np.float64]:
    """Return the noise at which mean Ψ_o falls through the middle between order and disorder.

    Order is mean Ψ_o at the noise of the strongest rotation: a jam has a high Ψ_o too, but does not
    rotate. Disorder is mean Ψ_o at the last noise. The curve is straight between levels. If it
    crosses the middle several times, the last crossing counts.

    Parameters
    ----------
    noise
        Shape (levels,), rising.
    psi_o, rotation
        Means of Ψ_o and ``|m|`` over runs, shape (levels, ...).

    Returns
    -------
    numpy.ndarray
        Shape (...); NaN for curves that hold NaN.
    """
    levels = np.asarray(noise, float)
    orders, rotations = np.asarray(psi_o, float), np.asarray(rotation, float)
    order_curves = orders.reshape(len(levels), -1).T
    rotation_curves = rotations.reshape(len(levels), -1).T
    noises = [
        _noise_at_middle(levels, *curves)
        for curves in zip(order_curves, rotation_curves, strict=True)
    ]
    return np.array(noises).reshape(orders.shape[1:])


def _noise_at_middle(
    levels: NDArray[np.float64], psi_o: NDArray[np.float64], rotation: NDArray[np.float64]
) -> float:
    """Return the noise at which one curve of Ψ_o last falls through its middle."""
    if np.isnan(psi_o).any() or np.isnan(rotation).any():
        return math.nan
    strongest = int(rotation.argmax())
    middle = (psi_o[strongest] + psi_o[-1]) / 2
    last_above = strongest + int(np.flatnonzero(psi_o[strongest:] >= middle)[-1])
    if last_above == len(levels) - 1:
        return float(levels[-1])
    fraction = (psi_o[last_above] - middle) / (psi_o[last_above] - psi_o[last_above + 1])
    return float(levels[last_above] + fraction * (levels[last_above + 1] - levels[last_above]))
