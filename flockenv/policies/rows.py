"""From what environments give to a policy to rows of single leaders, and back."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.errors import ParameterError

__all__ = ["rudders_for"]


def rudders_for(
    observation: ArrayLike | Mapping[Any, ArrayLike],
    size: int,
    steer: Callable[[NDArray[np.float32]], NDArray[np.floating[Any]]],
) -> Any:
    """Return rudders for observations in any of the forms that environments give.

    Parameters
    ----------
    observation
        Shape (..., m * size): m leaders' observations one after another in the last axis; or a
        dictionary of such arrays by agent.
    size
        Length of one leader's observation.
    steer
        Maps rows (leaders, size), float32, to rudders (leaders,).

    Returns
    -------
    numpy.ndarray or dict
        Shape (..., m), float32.

    Raises
    ------
    ParameterError
        If the last axis is no multiple of `size`.
    """
    if isinstance(observation, Mapping):
        return {agent: rudders_for(each, size, steer) for agent, each in observation.items()}
    array = np.ascontiguousarray(observation, np.float32)
    width = array.shape[-1] if array.ndim else 0
    if width == 0 or width % size != 0:
        raise ParameterError(
            f"observation has shape {array.shape}, which is not accepted: its last axis must be a "
            f"multiple of {size}, the size of a leader's observation"
        )
    rudders = np.asarray(steer(array.reshape(-1, size)), np.float32)
    return rudders.reshape(*array.shape[:-1], width // size)
