"""Law: order parameters are those of Section 3.2, of the normal boats or of all."""

import ast
import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv import Flock, OrderParameters, OrderSeries, ParameterError, _core


def test_no_boat_is_refused(parameters):
    flock = Flock(parameters.replace(n_boats=2, n_leaders=2), seed=1)
    with pytest.raises(ParameterError, match="at least one normal boat"):
        flock.order_parameters()
    assert flock.order_parameters(include_leaders=True).psi_o <= 1.0


def test_the_fields_that_are_written_out_are_those_of_the_table():
    """An editor completes `order.psi_o`, and mypy knows that it is a float."""
    tree = ast.parse(Path(flockenv.order.__file__).read_text(encoding="utf-8"))
    classes = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}
    written = [field.target.id for field in classes["_Recorded"].body]
    assert written == [each["name"] for each in _core.QUANTITIES if each["kind"] == "recorded"]
    assert [field.name for field in dataclasses.fields(OrderParameters)] == written


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


def test_values_that_are_not_given_are_undefined():
    order = OrderParameters(1.0, milling=0.5)
    assert (order.psi_o, order.milling) == (1.0, 0.5)
    assert math.isnan(order.c_v)
    assert order == OrderParameters(psi_o=1.0, milling=0.5)
    assert hash(order) == hash(OrderParameters(psi_o=1.0, milling=0.5))
    assert np.isnan(OrderSeries(np.ones(4)).nematic).all()
