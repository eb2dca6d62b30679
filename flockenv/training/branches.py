"""Training of leaders in pairs of flocks that branch from one state, in the core, without torch."""

import json
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
import tomli_w
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.arguments import as_int
from flockenv._io.atomic_write import atomic_write, write_text
from flockenv._io.interrupts import end_if_interrupted
from flockenv._io.plain_file import open_plain
from flockenv._io.toml import read_toml_file
from flockenv.comparison import run_episodes
from flockenv.errors import FlockError, ParameterError, refuse_unknown, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies import LeaningLaw
from flockenv.policies.names import PAPERS_LAW, TUNED_LAW
from flockenv.runs.store import RESULTS_VERSION
from flockenv.training.branching import branch_seed

CHECKPOINT, CURVE, POLICY, SETTINGS = "checkpoint.bin", "curve.csv", "policy.json", "settings.toml"
"""Files of a training."""

TRAINED = "trained"
"""Name of the trained leaders in a comparison."""

OPTIONS: tuple[str, ...] = tuple(option["name"] for option in _core.BRANCH_OPTIONS)
"""Names of the options of a training; docs/training_reference.md describes them."""

#: Shortest time between two checkpoints in s.
_BETWEEN_CHECKPOINTS_S = 5.0
_EPISODE_S = 480.0
_LARGEST_FILE = 1 << 30


@dataclass(frozen=True)
class Progress:
    """Progress of a training.

    Attributes
    ----------
    flock_hours, total
        Simulated time of all flocks together, now and at the end.
    signed_order
        Mean of the last round, in which leaders explore; NaN before the first round ends.
    """

    flock_hours: float
    total: float
    signed_order: float


Report = Callable[[Progress], object]
"""Function that takes the progress after each round."""


class BranchTraining:
    """A training in progress: `advance` it, and take its `policy` at any time.

    The same seed gives the same weights, bit for bit, on any number of threads. The leaders' leans
    or rudders are linear in the 29 lean features.

    Parameters
    ----------
    parameters
        Parameters of the flocks, in the pool ``"wide"`` or ``"narrow"``.
    seed
        Seed of the training, from 0 to 2³² - 1.
    options
        Options of the training that differ from the defaults of the ``action_mode``.

    Raises
    ------
    ParameterError
        For unknown options and values that are not accepted.
    """

    def __init__(self, parameters: FlockParameters, *, seed: int = 0, **options: object) -> None:
        refuse_unknown(options, OPTIONS, "option of the training")
        seed = as_int(seed, "seed")
        first_flock_seed = branch_seed(seed)
        self._core = _core.Trainer(parameters, options, seed, first_flock_seed)
        self.parameters = parameters

    @property
    def options(self) -> dict[str, Any]:
        """The value of every option by name, defaults included."""
        return self._core.options

    @property
    def has_ended(self) -> bool:
        """Whether the training has used all its flock-hours."""
        return self._core.has_ended

    @property
    def curve(self) -> dict[str, NDArray[np.float64]]:
        """Columns ``flock_hours`` and ``signed_order``, by round; leaders explore in a round."""
        rows = np.array(self._core.curve, float).reshape(-1, 2)
        return {"flock_hours": rows[:, 0], "signed_order": rows[:, 1]}

    @property
    def progress(self) -> Progress:
        """Progress of the training."""
        done, total = self._core.flock_hours
        orders = self.curve["signed_order"]
        return Progress(done, total, float(orders[-1]) if len(orders) else math.nan)

    @property
    def overlaps(self) -> tuple[int, int, float]:
        """Numbers of branches and of those with deep overlaps, and the deepest overlap in cm.

        Branches of whole rounds count. An overlap beyond ``tolerance_cm`` is deep.
        """
        return self._core.overlaps

    def advance(self) -> None:
        """Run a round: one branch of every pair, then an update of the weights.

        If Ctrl-C ends it early, the training is as before the round.
        """
        self._core.advance(self.options["pairs"])

    def policy(self, provenance: Mapping[str, str] | None = None) -> LeaningLaw:
        """Return the law whose weights are the mean over the second half of the rounds so far.

        Parameters
        ----------
        provenance
            Short texts by name for the policy's file.
        """
        values = json.loads(self._core.law.to_json())
        return LeaningLaw.from_json(json.dumps({**values, "provenance": dict(provenance or {})}))

    def to_bytes(self) -> bytes:
        """Return the state of the training after its last whole round, for `from_bytes`."""
        return self._core.to_bytes()

    @classmethod
    def from_bytes(cls, state: bytes, *, flock_hours: float | None = None) -> Self:
        """Return a stored training, which continues bit for bit.

        It ends after its own flock-hours, or after `flock_hours` if they are given.

        Raises FlockError for a state that is damaged, has another format, or is not finite.
        """
        training = cls.__new__(cls)
        training._core = _core.Trainer.from_bytes(state, flock_hours)
        training.parameters = FlockParameters.from_dict(training._core.parameters.values)
        return training


def training_flocks(pool: str = "wide", **changes: Any) -> FlockParameters:
    """Return the usual flocks of a training: 27 boats, three leaders, the pool's critical noise.

    They have the physics ``"training"``.

    Parameters
    ----------
    pool
        ``"wide"`` or ``"narrow"``.
    changes
        Fields of `flockenv.FlockParameters` that differ.
    """
    fields: dict[str, Any] = {"pool": pool, "n_boats": 27, "n_leaders": 3}
    fields |= _core.physics_fields("training")
    if "bw_s" not in changes:
        fields["bw_s"] = FlockParameters.critical_bw_s("simulation", pool)
    return FlockParameters(**{**fields, **changes})


def train(
    training: BranchTraining,
    folder: Path,
    command: str = "",
    report: Report = lambda progress: None,
) -> LeaningLaw:
    """Continue a training to its end, and return the policy.

    The folder gets ``settings.toml``, every few seconds ``checkpoint.bin``, and at the end
    ``policy.json`` and ``curve.csv``. Ctrl-C leaves a checkpoint of the last whole round.

    Parameters
    ----------
    training
        The training.
    folder
        Where to write.
    command
        The command that is stored in the policy's provenance.
    report
        Called after each round.
    """
    folder.mkdir(parents=True, exist_ok=True)
    settings = {"results_version": RESULTS_VERSION, "training": training.options}
    write_text(
        folder / SETTINGS, tomli_w.dumps({**settings, "flocks": training.parameters.to_dict()})
    )
    start, last_stored = time.process_time(), time.monotonic()
    try:
        while not training.has_ended:
            training.advance()
            report(training.progress)
            if time.monotonic() - last_stored > _BETWEEN_CHECKPOINTS_S:
                _store_checkpoint(training, folder)
                last_stored = time.monotonic()
            end_if_interrupted()
    finally:
        _store_checkpoint(training, folder)
    policy = training.policy(_provenance(training, command, time.process_time() - start))
    policy.save(folder / POLICY)
    points = zip(*training.curve.values(), strict=True)
    lines = ["flock_hours,signed_order", *(f"{hours:.6g},{order:.5f}" for hours, order in points)]
    write_text(folder / CURVE, "\n".join(lines) + "\n")
    return policy


def stored_training(folder: Path, flock_hours: float | None = None) -> BranchTraining:
    """Return the training of a folder's checkpoint, with other `flock_hours` if they are given.

    Raises
    ------
    ParameterError
        If there is no checkpoint, or it is damaged or of another results version.
    """
    path = folder / CHECKPOINT
    if not path.exists():
        raise ParameterError(f"{folder} holds no checkpoint of branches to resume")
    version = read_toml_file(folder / SETTINGS, str(folder / SETTINGS)).get("results_version")
    if version != RESULTS_VERSION:
        raise ParameterError(
            f"{folder} was trained in results version {short_repr(version)}, and this flockenv has "
            f"version {RESULTS_VERSION}: start again"
        )
    with open_plain(path) as file:
        state = file.read(_LARGEST_FILE)
    try:
        return BranchTraining.from_bytes(state, flock_hours=flock_hours)
    except FlockError as error:
        raise ParameterError(f"{path} is not a checkpoint: {error}") from error


def compare_with_laws(
    policy: LeaningLaw, parameters: FlockParameters, flocks: int
) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return what `run_episodes` measures in new flocks, by the name of the policy that leads them.

    Parameters
    ----------
    policy
        The trained leaders.
    parameters
        Parameters of the flocks.
    flocks
        Number of flocks. The laws and the trained leaders get the same starts and noises.
    """
    policies: dict[str, Any] = {PAPERS_LAW: PAPERS_LAW, TUNED_LAW: TUNED_LAW, TRAINED: policy}
    seeds = range(flocks)
    options = {"target": "random"}
    return {
        name: run_episodes(parameters, leaders, seeds, _EPISODE_S, options=options)
        for name, leaders in policies.items()
    }


def _store_checkpoint(training: BranchTraining, folder: Path) -> None:
    with atomic_write(folder / CHECKPOINT) as file:
        file.write(training.to_bytes())


def _provenance(training: BranchTraining, command: str, cpu_s: float) -> dict[str, str]:
    """Return the texts that a policy's file holds about its training."""
    flock_hours = training.progress.flock_hours
    return {
        "command": command,
        "flockenv": _core.__version__,
        "results_version": str(RESULTS_VERSION),
        "flock_hours": f"{flock_hours:.6g}",
        "cpu_s": f"{cpu_s:.0f}",
    }
