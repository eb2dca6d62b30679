"""The baseline of a policy gradient: returns as a linear function of what is seen."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["least_squares"]

_REGULARIZATION = 1e-3


def least_squares(
    inputs: NDArray[np.float32], returns: NDArray[np.float64], share: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return weights and constant of the linear function nearest to returns over their shares."""
    size = inputs.shape[2] + 1
    squares, products = np.zeros((size, size)), np.zeros(size)
    for rows, wanted, part in zip(inputs, returns, share, strict=True):
        row = np.concatenate([rows, np.ones((len(rows), 1))], axis=1) * part
        squares += row.T @ row
        products += row.T @ wanted
    regularization = _REGULARIZATION * np.trace(squares) / size
    solution: NDArray[np.float64] = np.linalg.solve(
        squares + regularization * np.eye(size), products
    )
    return solution
