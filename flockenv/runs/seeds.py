"""One table of seed ranges by use, so that no policy is judged by a seed that it was made with."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from flockenv.errors import ParameterError, short_repr

FIRST_TRAINING_SEED = 1 << 32
"""Seeds from this one on make policies; smaller seeds judge them."""


@dataclass(frozen=True, slots=True)
class SeedRange:
    """The seeds of one use, divided equally among its runs."""

    use: str
    #: First seed of run 0.
    first: int
    of_a_run: int  #: Number of seeds of each run.
    runs: int = 1  #: Number of runs.

    @property
    def every(self) -> range:
        """The seeds of all runs."""
        return range(self.first, self.first + self.runs * self.of_a_run)

    def seeds(self, count: int, run: int = 0, start: int = 0) -> range:
        """Return `count` seeds of a run from index `start` on; refuse more than the run has."""
        # The options of commands call the number of a run its seed.
        if not 0 <= run < self.runs:
            raise ParameterError(
                f"seed = {short_repr(run)} is not accepted: from 0 to {self.runs - 1}"
            )
        if not 0 <= start <= start + count <= self.of_a_run:
            raise ParameterError(
                f"{short_repr(start + count)} seeds are not accepted: there are {self.of_a_run} "
                f"for each run of {self.use}"
            )
        first = self.first + run * self.of_a_run + start
        return range(first, first + count)


# A run's number has 32 bits, as seeds in CMA-ES and NumPy. Each run of a search has 2^24 seeds.
_RUNS = 1 << 32
_FIRST_JUDGMENT = FIRST_TRAINING_SEED - (1 << 16)


def _search(use: str, index: int) -> SeedRange:
    """Return the range of a search that makes policies; searches of different indices differ."""
    return SeedRange(use, FIRST_TRAINING_SEED + index * (_RUNS << 24), 1 << 24, _RUNS)


POLICY_SEEDS: Mapping[str, SeedRange] = {
    seeds.use: seeds
    for seeds in (
        SeedRange("evaluation", 0, 3_000_000_000),
        # Seeds of studies; no policy was made with them. `release_seeds` may return seeds of this
        # range, too. It does for "train_leaders", so some of these seeds judged trainings.
        SeedRange("paper", 3_000_000_000, _FIRST_JUDGMENT - 3_000_000_000),
        # Used to judge the model's constants, which the last two ranges searched and chose.
        SeedRange("calibration judgment", _FIRST_JUDGMENT, 1 << 16),
        SeedRange("training", FIRST_TRAINING_SEED, 1 << 20, _RUNS),
        _search("law tuning", 1),
        _search("evolution strategy", 2),
        # Used to choose one of several policies.
        SeedRange("validation", FIRST_TRAINING_SEED + 3 * (_RUNS << 24), 1 << 24),
        _search("easy environment", 5),
        _search("branches", 6),
        _search("offline data", 7),
        _search("roles", 8),
        SeedRange("calibration search", FIRST_TRAINING_SEED + 9 * (_RUNS << 24), 1 << 24),
        SeedRange("calibration choice", FIRST_TRAINING_SEED + 10 * (_RUNS << 24), 1 << 24),
    )
}
"""The seeds that make and judge policies and constants, by use; no two ranges overlap."""


def check_evaluation_seeds(seeds: Iterable[int]) -> None:
    """Refuse seeds that policies are trained on."""
    # All seeds of a range lie between its ends.
    for seed in (*seeds[:1], *seeds[-1:]) if isinstance(seeds, range) else seeds:
        if not 0 <= seed < FIRST_TRAINING_SEED:
            raise ParameterError(
                f"seed = {short_repr(seed)} is not accepted: seeds for evaluation are from 0 to "
                "2^32 - 1, those above are for training"
            )


def release_seeds(tag: str, count: int) -> range:
    """Return the seeds for the final tables of a release, given its tag.

    The first seed is the first eight bytes of the tag's SHA-256 as a big-endian number, modulo 2^32
    minus the count. So nobody can choose these seeds for a good result.
    """
    if not 1 <= count < FIRST_TRAINING_SEED:
        raise ParameterError(f"count = {short_repr(count)} is not accepted: from 1 to 2^32 - 1")
    number = int.from_bytes(hashlib.sha256(tag.encode()).digest()[:8], "big")
    first = number % (FIRST_TRAINING_SEED - count)
    return range(first, first + count)
