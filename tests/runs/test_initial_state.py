"""Flocks in an initial state are what its name says, on paper: m = 1 and Ψ_o cos φ_o = 1."""

import numpy as np
import pytest

import flockenv
from flockenv.runs.protocols.hysteresis import simulate_prepared
from flockenv.runs.protocols.initial_state import STARTS, initial_flock

PARAMETERS = flockenv.FlockParameters.preset("simulation").replace(
    n_boats=20, n_leaders=0, bw_s=0.0
)


def test_the_states() -> None:
    rotating, jammed = (initial_flock(PARAMETERS, 2, start) for start in STARTS)
    order = rotating.order_parameters()
    assert (order.psi_o, order.phi_o) == pytest.approx((1.0, np.pi / 2))
    assert (order.psi_v, order.phi_v) == pytest.approx((PARAMETERS.speed_cm_s, np.pi / 2))
    order = jammed.order_parameters()
    assert (order.psi_o, order.phi_o, order.psi_v) == pytest.approx((1.0, 0.0, 0.0))
    random = flockenv.Flock(PARAMETERS, 2)
    assert (jammed.pose[:, :2] == random.pose[:, :2]).all()


@pytest.mark.parametrize("start", STARTS)
def test_runs_are_seeded_and_come_apart(start: str) -> None:
    run = simulate_prepared(PARAMETERS, 3, 60.0, 1.0, start)
    assert len(run.time_s) == 61
    assert run == simulate_prepared(PARAMETERS, 3, 60.0, 1.0, start)
    assert run != simulate_prepared(PARAMETERS, 4, 60.0, 1.0, start)
    flock = flockenv.Flock(PARAMETERS, 0)
    flock.set_state(run.pose[-1], run.velocity[-1], allow_overlap=True)
    assert min(flock.contacts().gap_cm, default=0.0) > -0.1


def test_an_unknown_start_is_refused() -> None:
    with pytest.raises(flockenv.ParameterError, match="rotating, jammed"):
        initial_flock(PARAMETERS, 0, "asleep")
