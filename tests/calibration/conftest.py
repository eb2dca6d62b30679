import itertools

import numpy as np
import pytest

from flockenv.calibration import held_out, surrogate, targets, tradeoffs
from flockenv.calibration import search as fit_search
from flockenv.calibration.flock_runs import QUANTITIES, FlockRuns


@pytest.fixture
def quick(monkeypatch):
    """Replace 8-minute runs by a formula of c3, c4 and leaders; count the sets of runs."""
    calls = itertools.count()

    def run_flocks(parameters, design, seeds, jobs=1, progress=lambda: None):
        next(calls)
        rows = design.seeds(seeds)
        values = np.empty((len(design.cells), len(rows), len(QUANTITIES)))
        for place, cell in enumerate(design.cells):
            for row, seed in enumerate(rows):
                luck = np.random.default_rng(seed[place]).normal(0, 0.02)
                middle = 1.4 + 0.2 * cell.leaders + 0.3 * np.log(parameters.c3 / 0.13)
                psi_o = float(np.clip(1.5 * (middle - cell.bw_s) + 0.56, 0.2, 0.95)) + luck
                jam = float(np.clip(0.2 * parameters.c4 / 0.01 - cell.bw_s / 4, 0.0, 1.0))
                ordering_s = 200.0 - 20.0 * cell.bw_s if psi_o > 0.8 else np.nan
                following = psi_o - 0.2 if cell.alternates else np.nan
                values[place, row] = [
                    *(psi_o, psi_o, 0.7, jam, 0.05, 0.7, 100.0 * psi_o),
                    *(ordering_s, following),
                ]
                progress()
        return FlockRuns(design, values)

    for module, name, value in (
        (fit_search, "run_flocks", run_flocks),
        (held_out, "run_flocks", run_flocks),
        # Few places and draws are enough for laws that hold of any number.
        (surrogate, "_CANDIDATES", 100),
        (tradeoffs, "_CLOUD", 100),
        (targets, "_SETS", 50),
        (held_out, "_RESAMPLES", 10),
    ):
        monkeypatch.setattr(module, name, value)
    return calls
