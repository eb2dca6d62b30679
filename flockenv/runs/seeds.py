"""Seeds for training and seeds for evaluation: two ranges that never meet."""

import itertools
from collections.abc import Iterable

from flockenv.errors import ParameterError, shown

__all__ = ["FIRST_TRAINING_SEED", "check_evaluation_seeds", "training_seed"]

FIRST_TRAINING_SEED = 1 << 32
"""Seeds from here on are for training and tuning, those below for evaluation."""


def training_seed(number: int) -> int:
    """Return the training seed of a number from 0 to 2^63 - 1.

    Raises
    ------
    ParameterError
        For numbers out of range.
    """
    if not 0 <= number < 1 << 63:
        raise ParameterError(f"seed = {shown(number)} is not accepted: from 0 to 2^63 - 1")
    return FIRST_TRAINING_SEED + number


def check_evaluation_seeds(seeds: Iterable[int]) -> None:
    """Refuse seeds that policies are trained on.

    Raises
    ------
    ParameterError
        For a seed out of range.
    """
    # Of a range the ends are enough, however long it is.
    ends = (seeds[:1], seeds[-1:]) if isinstance(seeds, range) else (seeds,)
    for seed in itertools.chain(*ends):
        if not 0 <= seed < FIRST_TRAINING_SEED:
            raise ParameterError(
                f"seed = {shown(seed)} is not accepted: seeds for evaluation are from 0 to "
                "2^32 - 1, those above are for training"
            )
