"""Seeds of the environments: given to a reset, or drawn from the environment's own generator."""

from collections.abc import Sequence

import gymnasium.utils.seeding
import numpy as np

from flockenv._io.arguments import as_int, materialized
from flockenv.errors import ParameterError, short_repr

_SEED_LIMIT = 2**64


class Seed(int):
    """A seed in infos: an int, but of a class of its own.

    Gymnasium puts plain ints into int64 arrays, in which seeds from 2^63 on do not fit.
    """


class OwnGenerator:
    """Gymnasium's `np_random`, for environments of other libraries.

    The generator is made at its first use. So copies of an environment that was never reset have
    different flocks, and copies of one that was reset continue alike.
    """

    _np_random: np.random.Generator | None = None
    _np_random_seed: int | None = None

    @property
    def np_random(self) -> np.random.Generator:
        """The generator that draws a seed if a reset is given none."""
        if self._np_random is None:
            self._seed_generator(None)
        assert self._np_random is not None
        return self._np_random

    @np_random.setter
    def np_random(self, generator: np.random.Generator) -> None:
        self._np_random, self._np_random_seed = generator, -1

    @property
    def np_random_seed(self) -> int:
        """The seed of `np_random`; -1 for a generator that was set."""
        if self._np_random_seed is None:
            self._seed_generator(None)
        assert self._np_random_seed is not None
        return self._np_random_seed

    def _seed_generator(self, seed: int | None) -> None:
        self._np_random, self._np_random_seed = gymnasium.utils.seeding.np_random(seed)


def drawn_seed(random: np.random.Generator) -> int:
    """Draw a seed below 2^63 for an environment without one."""
    return int(random.integers(_SEED_LIMIT // 2))


def seed_of(seed: object) -> int:
    """Return the seed of one flock as an int; refuse anything but a whole number in its range."""
    return seeds_from(seed, 1)[0]


def seeds_from(first: object, flocks: int) -> list[int]:
    """Return the seeds first, first + 1 and so on, one for each of a number of flocks."""
    first_seed = as_int(first, "seed")
    if not 0 <= first_seed <= _SEED_LIMIT - flocks:
        raise ParameterError(
            f"seed = {short_repr(first_seed)} is not accepted: at least 0, and below 2^64 for the "
            f"last of {flocks} flocks"
        )
    return [first_seed + flock for flock in range(flocks)]


def seeds_of_flocks(seed: object, flocks: int) -> Sequence[int | None]:
    """Return the seed of each flock, from the seed of the first one or a list with a seed for each.

    A flock with None continues with its next episode.
    """
    if seed is None:
        return [None] * flocks
    seeds = seed.tolist() if isinstance(seed, np.ndarray) else materialized(seed)
    if not isinstance(seeds, Sequence) or isinstance(seeds, str | bytes):
        return seeds_from(seeds, flocks)
    if len(seeds) != flocks:
        raise ParameterError(f"seed lists {len(seeds)} seeds, expected {flocks}")
    return [None if seed is None else seed_of(seed) for seed in seeds]
