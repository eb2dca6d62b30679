"""Changes of the fitted preset: each differs from it in what its name says, on the same seeds."""

import numpy as np
import pytest

from flockenv import FlockParameters
from flockenv.calibration.flock_runs import QUANTITIES, Cell, Design, FlockRuns, run_flocks
from flockenv.calibration.targets import TARGETS

PRESET = FlockParameters.preset("experiment")


def test_each_change_differs_in_what_it_says(script) -> None:
    def changed(name: str) -> dict[str, float]:
        after = script.CHANGES[name].parameters(PRESET).to_dict()
        return {key: after[key] for key, value in PRESET.to_dict().items() if after[key] != value}

    assert changed("none") == changed("tuned damped law") == changed("24 minutes") == {}
    rudder = changed("10 times the rudder")
    assert set(rudder) == {"c2", "turning_bias"}
    # Normal boats turn as before.
    assert rudder["c2"] == pytest.approx(10 * PRESET.c2)
    assert rudder["c2"] * rudder["turning_bias"] == pytest.approx(PRESET.c2 * PRESET.turning_bias)
    assert set(changed("all three")) == set(changed("both")) == {*rudder, "leader_speed_factor"}
    assert changed("no current") == {"current_gain": 0.0}
    longer = script.CHANGES["24 minutes"].design.cells
    assert {cell.duration_s for cell in longer if not cell.alternates} == {1440.0}
    assert set(script.SHOWN) <= {target.key for target in TARGETS}


def test_a_policy_steers_the_runs(script) -> None:
    design = Design((Cell(3, 1.0, 24.0), Cell(0, 1.0, 24.0)))
    policy = script.CHANGES["tuned damped law"].policy
    law, tuned = (run_flocks(PRESET, design, [4, 5], policy=each) for each in (None, policy))
    # Without leaders nobody is steered.
    assert not np.array_equal(law.values[0], tuned.values[0])
    assert np.array_equal(law.values[1], tuned.values[1], equal_nan=True)


def test_differences_are_paired(script) -> None:
    values = np.random.default_rng(1).uniform(0.2, 0.4, (19, 6, len(QUANTITIES)))
    more = values.copy()
    more[..., QUANTITIES.index("jammed")] += 0.1
    runs = [FlockRuns(script.JUDGED, each) for each in (values, more)]
    boat = dict.fromkeys((target.key for target in TARGETS if target.value is None), 1.0)
    before, after = (script.resampled(boat, each) for each in runs)
    assert len(before) == 1 + script.RESAMPLES
    assert (after["jamming"] - before["jamming"]).to_numpy() == pytest.approx(0.1)
