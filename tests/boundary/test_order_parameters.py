"""Law: order parameters are those of Section 3.2, of the normal boats or of all."""

import math
import pickle

import numpy as np
import pytest

import flockenv
from flockenv import Flock, OrderParameters, OrderSeries, ParameterError


def circling(parameters, n, n_leaders=0, speed=10.0):
    """All boats on a circle, heading and moving clockwise."""
    flock = Flock(parameters.replace(n_boats=n, n_leaders=n_leaders, pool="wide"), seed=1)
    angles = 2 * np.pi * np.arange(n) / n
    headings = angles - np.pi / 2
    pose = np.column_stack([140 * np.cos(angles), 140 * np.sin(angles), headings])
    velocity = speed * np.column_stack([np.cos(headings), np.sin(headings), 0 * headings])
    flock.set_state(pose, velocity)
    return flock


def test_clockwise_circling_is_perfect_order(parameters):
    order = circling(parameters, 10).order_parameters()
    expected = OrderParameters(1.0, math.pi / 2, 1.0, 10.0, math.pi / 2, 100.0)
    for name in ("psi_o", "phi_o", "c_o", "psi_v", "phi_v", "c_v"):
        assert getattr(order, name) == pytest.approx(getattr(expected, name)), name


def test_one_boat_has_no_pair(parameters):
    order = circling(parameters, 1).order_parameters()
    assert order.psi_o == pytest.approx(1.0)
    assert math.isnan(order.c_o)
    assert math.isnan(order.c_v)


def test_no_boat_is_refused(parameters):
    flock = Flock(parameters.replace(n_boats=2, n_leaders=2), seed=1)
    with pytest.raises(ParameterError, match="at least one normal boat"):
        flock.order_parameters()
    assert flock.order_parameters(include_leaders=True).psi_o <= 1.0


def test_order_parameters_are_plain_values(flock):
    order = flock.order_parameters()
    assert pickle.loads(pickle.dumps(order)) == order
    assert repr(order).startswith("OrderParameters(psi_o=0.")


def test_a_series_compares_and_indexes(parameters):
    series = [flockenv.simulate(parameters, 1, 1.0, seed_hz).order for seed_hz in (10, 10, 5)]
    assert series[0] == series[1] != series[2]
    assert series[0][0] == series[2][0]
    assert len(series[0]) == 11


def test_series_of_different_lengths_are_refused():
    series = OrderSeries(psi_o=np.ones(3), phi_o=np.ones(2))
    for derive in (lambda: series.signed_order("cw"), series.rotation, series.outward):
        with pytest.raises(ParameterError, match="phi_o"):
            derive()


def test_arguments_and_attributes_that_are_unknown_are_named():
    with pytest.raises(TypeError, match="'psi'"):
        OrderParameters(psi=1.0)
    with pytest.raises(TypeError, match="multiple values for argument 'psi_o'"):
        OrderSeries(np.ones(2), psi_o=np.ones(2))
    with pytest.raises(AttributeError, match="no attribute 'psi'"):
        _ = OrderParameters(1.0).psi
    with pytest.raises(ParameterError, match="psi_o, phi_o"):
        OrderSeries(np.ones(2)).series("psi")


def test_values_that_are_not_given_are_undefined():
    order = OrderParameters(1.0, milling=0.5)
    assert (order.psi_o, order.milling) == (1.0, 0.5)
    assert math.isnan(order.c_v)
    assert order == OrderParameters(psi_o=1.0, milling=0.5)
    assert hash(order) == hash(OrderParameters(psi_o=1.0, milling=0.5))
    assert np.isnan(OrderSeries(np.ones(4)).nematic).all()
