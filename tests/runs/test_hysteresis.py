"""Loops go there and back: the same parameters at both ends, boats carried over, no overlap.

On paper: a pool of twice the area has radii √2 times as long, or, at the same width, a mean
circumference twice as long.
"""

import numpy as np
import pytest

import flockenv
from flockenv.runs.protocols.hysteresis import (
    DENSITY_RATIO,
    LOOPS,
    density_steps,
    loop_position,
    noise_steps,
    radii_cm,
    resized,
    simulate_loop,
)

PARAMETERS = flockenv.FlockParameters.preset("simulation").replace(n_boats=10, bw_s=0.5)
LONG = PARAMETERS.replace(pool=(300.0, 217.0))
"""Long enough for its circumference to shrink to a quarter."""


def test_pools() -> None:
    assert radii_cm("wide") == (180.0, 97.0)
    assert radii_cm((60.0, 0.0)) == (60.0, 0.0)
    outer, inner = resized("wide", 2.0, fixed_width=False)
    assert (outer, inner) == pytest.approx((180 * 2**0.5, 97 * 2**0.5))
    outer, inner = resized("wide", 2.0, fixed_width=True)
    assert outer - inner == pytest.approx(83.0)
    assert outer + inner == pytest.approx(2 * 277.0)
    with pytest.raises(flockenv.ParameterError, match="no inner wall"):
        resized("wide", 0.25, fixed_width=True)
    with pytest.raises(flockenv.ParameterError, match="open water"):
        resized((np.inf, 0.0), 2.0, fixed_width=False)
    with pytest.raises(flockenv.ParameterError, match="narrow"):
        radii_cm("table-2")


def test_steps() -> None:
    levels = [parameters.bw_s for parameters in noise_steps(PARAMETERS)]
    assert (levels[0], levels[-1]) == (0.0, 0.5)
    assert np.diff(levels) == pytest.approx(0.025)
    for fixed_width in (False, True):
        steps = density_steps(LONG, fixed_width)
        areas = [np.subtract(*np.square(radii_cm(parameters.pool))) for parameters in steps]
        assert areas[0] / areas[-1] == pytest.approx(DENSITY_RATIO)
        assert (np.diff(areas) < 0).all()
    assert loop_position(np.array([0.0, 25.0, 50.0, 100.0]), 100.0).tolist() == [0, 0.5, 1, 0]


@pytest.mark.parametrize("kind", LOOPS)
def test_a_loop_is_continuous_and_seeded(kind: str) -> None:
    loop = simulate_loop(LONG, 3, 120.0, 10.0, kind)
    assert loop.time_s == pytest.approx(np.arange(1201) / 10)
    assert loop == simulate_loop(LONG, 3, 120.0, 10.0, kind)
    assert loop != simulate_loop(LONG, 4, 120.0, 10.0, kind)
    steps = np.hypot(*np.diff(loop.pose[:, :, :2], axis=0).T)
    # 15 cm/s and what the pool's resizing adds: 0.6 % of at most 300 cm a step.
    assert steps.max() < 1.5 + 1.8 + 0.1
    assert loop.order.rotation()[0] == pytest.approx(1.0)


def test_a_dense_loop_keeps_boats_inside_and_apart() -> None:
    parameters = PARAMETERS.replace(n_boats=45, bw_s=0.0)
    loop = simulate_loop(parameters, 1, 60.0, 10.0, "rotating-density-loop")
    middle = int(np.argmax(loop_position(loop.time_s, 60.0)))
    smallest = density_steps(parameters, fixed_width=False)[-1]
    flock = flockenv.Flock(smallest, 0)
    # Refuses whatever overlaps by more than the solver leaves; a step's own overlap is 0.05 cm.
    flock.set_state(loop.pose[middle], loop.velocity[middle], allow_overlap=True)
    assert min(flock.contacts().gap_cm, default=0.0) > -0.1


def test_the_noise_loop_ends_as_it_started(monkeypatch: pytest.MonkeyPatch) -> None:
    loop = simulate_loop(PARAMETERS, 5, 400.0, 10.0, "rotating-noise-loop")
    backing = loop.phase == "bw"
    thirds = np.array_split(backing, 5)
    shares = [float(third.mean()) for third in thirds]
    assert shares[2] > shares[1] > shares[0]
    assert shares[2] > shares[3] > shares[4]
