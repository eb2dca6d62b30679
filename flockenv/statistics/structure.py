"""Structure of a flock: positions and headings of boats relative to each other and to the wall."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import with_gaps
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters


def structure_series(
    name: str, parameters: FlockParameters, pose: ArrayLike
) -> NDArray[np.float64]:
    """Return a quantity of structure at each time, shape (t,); NaN if no boat is present.

    Parameters
    ----------
    name
        A name in the table of quantities: ``"largest_cluster"``, ``"on_outer_wall"`` or
        ``"polarization"``. The polarization is 1 if all boats have the same heading in the axes of
        the world, and about 0.886/√n if n headings are independent (Vicsek et al. 1995). It is
        small if boats go around the pool; Ψ_o, whose orientations are relative to the pool, is not.
    parameters
        Parameters of the flock; only the hull and the pool matter.
    pose
        Shape (t, n, 3), as in a `Recording`.

    Raises
    ------
    ParameterError
        For another name or shape, and numbers that are not finite.
    """
    return _core.structure_series(name, parameters, _poses(pose))


def jam_sizes(parameters: FlockParameters, pose: ArrayLike) -> list[NDArray[np.int64]]:
    """Return the numbers of boats in the jams: for each time an array, ascending.

    A jam has at least three boats with gaps below 0.5 cm that face outward within 60°.

    The arguments and errors are those of `structure_series`.
    """
    sizes_by_time = _core.jam_sizes(parameters, _poses(pose))
    return [np.sort(np.array(sizes, np.int64)) for sizes in sizes_by_time]


def _poses(pose: ArrayLike) -> NDArray[np.float64]:
    """Return poses as an array, with rows of NaN for missing boats; refuse anything else."""
    poses = with_gaps(pose, "pose")
    if poses.ndim != 3:
        raise ParameterError(f"pose has shape {poses.shape}, expected (t, n, 3)")
    absent = np.isnan(poses).all(axis=-1)
    if not np.isfinite(poses[~absent]).all():
        raise ParameterError(
            "pose is not accepted: finite numbers, or rows of NaN for missing boats"
        )
    return poses
