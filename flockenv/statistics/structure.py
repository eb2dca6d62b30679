"""Where boats are: relative to each other, to the wall, and to where they were."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters


def structure_series(
    name: str, parameters: FlockParameters, pose: ArrayLike
) -> NDArray[np.float64]:
    """Return a quantity of structure at each time, shape (t,); NaN where no boat is there.

    Parameters
    ----------
    name
        Of the table of quantities: ``"largest_cluster"``, ``"on_outer_wall"`` or
        ``"polarization"``, which is 1 where all boats point the same way in the axes of the world,
        wherever they are, and some 0.886/√n where n headings are independent (Vicsek et al. 1995).
        Unlike Ψ_o, whose orientations are relative to the pool, it is small where boats go around
        the pool.
    parameters
        Of the flock: hull and pool are taken from them.
    pose
        Shape (t, n, 3), as in a `Recording`.

    Raises
    ------
    ParameterError
        For another name or shape, and numbers that are not finite.
    """
    return _core.structure_series(name, parameters, _poses(pose))


def jam_sizes(parameters: FlockParameters, pose: ArrayLike) -> list[NDArray[np.int64]]:
    """Return how many boats each jam holds, an array of ascending numbers for each time.

    A jam has at least three boats with gaps below 0.5 cm that face outward within 60°.

    Parameters and errors are those of `structure_series`.
    """
    found = _core.jam_sizes(parameters, _poses(pose))
    return [np.sort(np.array(sizes, np.int64)) for sizes in found]


def pair_distribution(pose: ArrayLike, edges: ArrayLike) -> NDArray[np.float64]:
    """Return how much likelier pairs of boats are at a distance than independent boats.

    Independent boats have the same distances from the pool's center as those found, and polar
    angles of their own: the walls' part in where boats are is divided out.

    Parameters
    ----------
    pose
        Shape (t, n, 3), as in a `Recording`.
    edges
        Edges of b bins of the distance of centers in cm, increasing, shape (b + 1,).

    Returns
    -------
    float64 array, shape (b,)
        1 for independent boats; NaN where none could be.

    Raises
    ------
    ParameterError
        For another shape, and edges that do not increase.
    """
    found, expected = _core.pair_counts(_poses(pose), np.asarray(edges, np.float64))
    return np.divide(found, expected, out=np.full_like(found, np.nan), where=expected > 0.0)


def mean_square_displacement(pose: ArrayLike, lags: Sequence[int]) -> NDArray[np.float64]:
    """Return the mean-square displacement of a boat after some numbers of samples, in cm².

    Means are over boats and over all pairs of samples so far apart; NaN where there are none. A
    ParameterError refuses poses of a shape other than (t, n, 3), and negative lags.
    """
    return _core.lagged_motion(_poses(pose), _samples(lags))[0]


def heading_correlation(pose: ArrayLike, lags: Sequence[int]) -> NDArray[np.float64]:
    """Return the mean cosine of a boat's turn after some numbers of samples: 1 for none.

    Means and errors are those of `mean_square_displacement`. Boats keep their heading for about as
    long as this stays above 1/e, their persistence time.
    """
    return _core.lagged_motion(_poses(pose), _samples(lags))[1]


def _poses(pose: ArrayLike) -> NDArray[np.float64]:
    poses = np.ma.asarray(pose, np.float64).filled(np.nan)
    if poses.ndim != 3:
        raise ParameterError(f"pose has shape {poses.shape}, expected (t, n, 3)")
    absent = np.isnan(poses).all(axis=-1)
    if not np.isfinite(poses[~absent]).all():
        raise ParameterError(
            "pose is not accepted: finite numbers, or rows of NaN for boats that are not there"
        )
    return poses


def _samples(lags: Sequence[int]) -> list[int]:
    if any(lag < 0 for lag in lags):
        raise ParameterError(f"lags = {list(lags)} is not accepted: numbers of samples, at least 0")
    return [int(lag) for lag in lags]
