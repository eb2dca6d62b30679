"""Flocks in an initial state are what its name says, on paper: m = 1 and Ψ_o cos φ_o = 1."""

import numpy as np
import pytest

import flockenv
from flockenv.runs.protocols.hysteresis import simulate_prepared
from flockenv.runs.protocols.initial_state import STARTS, initial_flock
from flockenv.statistics.structure import jam_sizes

PARAMETERS = flockenv.FlockParameters.preset("simulation").replace(
    n_boats=20, n_leaders=0, bw_s=0.0
)


def test_the_states() -> None:
    rotating, jammed, one_jam = (initial_flock(PARAMETERS, 2, start) for start in STARTS)
    order = rotating.order_parameters()
    assert (order.psi_o, order.phi_o) == pytest.approx((1.0, np.pi / 2))
    assert (order.psi_v, order.phi_v) == pytest.approx((PARAMETERS.speed_cm_s, np.pi / 2))
    order = jammed.order_parameters()
    assert (order.psi_o, order.phi_o, order.psi_v) == pytest.approx((1.0, 0.0, 0.0))
    order = one_jam.order_parameters()
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


@pytest.mark.parametrize("n_boats", [20, 60])
def test_one_jam_is_one_jam_without_overlap(n_boats: int) -> None:
    # On paper: the wall of narrow is 2π·90 cm long, of which hulls 10 cm wide take three quarters
    # when some 40 boats stand side by side; 60 stand in two rows.
    parameters = PARAMETERS.replace(n_boats=n_boats, pool="narrow")
    flock = initial_flock(parameters, 2, "one-jam")
    assert min(flock.contacts().gap_cm, default=0.0) > -1e-9
    (sizes,) = jam_sizes(parameters, flock.pose[None])
    assert sizes.tolist() == [n_boats]
    distance = np.unique(np.hypot(flock.pose[:, 0], flock.pose[:, 1]).round(6))
    assert len(distance) == (1 if n_boats == 20 else 2)
    other = initial_flock(parameters, 3, "one-jam")
    assert (other.pose != flock.pose).any()


def test_too_many_boats_for_one_jam_are_refused() -> None:
    parameters = PARAMETERS.replace(n_boats=100, pool=(200.0, 170.0))
    with pytest.raises(flockenv.ParameterError, match="100 boats are too many for one jam"):
        initial_flock(parameters, 0, "one-jam")


def test_an_unknown_start_is_refused() -> None:
    with pytest.raises(flockenv.ParameterError, match="rotating, jammed, one-jam"):
        initial_flock(PARAMETERS, 0, "asleep")
