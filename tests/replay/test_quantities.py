"""Law: a page charts what the recordings hold, and opens at the minute of the largest change."""

import dataclasses

import numpy as np
import pytest

import flockenv
from flockenv.order import ORDER, OrderSeries
from flockenv.replay.quantities import decisive_minute, series_of, shown_quantities

PARAMETERS = flockenv.FlockParameters(n_boats=4, n_leaders=1, target="cw")


@pytest.fixture(scope="module")
def constant() -> flockenv.Recording:
    return flockenv.simulate(PARAMETERS, 1, 400.0, 2.0)


def with_signed_order(recording: flockenv.Recording, values) -> flockenv.Recording:
    """The recording with this signed order: Ψ_o its size, φ_o along or against the target."""
    values = np.asarray(values, float)
    phi = np.where(values < 0, -np.pi / 2, np.pi / 2)
    columns = {name: getattr(recording.order, name) for name in ORDER}
    order = OrderSeries(**columns | {"psi_o": np.abs(values), "phi_o": phi})
    return dataclasses.replace(recording, order=order)


def test_one_run_opens_where_its_order_changes_most(constant):
    # A step at 210 s, and a smaller one at 60 s.
    time_s = constant.time_s
    run = with_signed_order(constant, np.where(time_s < 60, 0.0, np.where(time_s < 210, -0.4, 0.5)))
    start, words = decisive_minute([run])
    assert start == 180.0
    assert "180 s, the start of the minute in which order changes most" in words


def test_two_runs_open_where_they_differ_most(constant):
    time_s = constant.time_s
    flat = with_signed_order(constant, np.full(len(time_s), 0.5))
    apart = with_signed_order(constant, np.where(abs(time_s - 300) <= 30, -0.5, 0.5))
    start, words = decisive_minute([flat, apart])
    assert start == 270.0
    assert "differ most" in words
    assert decisive_minute([apart, flat])[0] == 270.0


def test_of_runs_of_different_lengths_and_rates_what_they_share_counts(constant):
    short = flockenv.simulate(PARAMETERS, 1, 100.0, 10.0)
    time_s = constant.time_s
    run = with_signed_order(constant, np.where(time_s < 300, 0.0, -1.0))
    start, _ = decisive_minute([run, with_signed_order(short, np.linspace(0, 1, len(short)))])
    assert start == 40.0


def test_without_a_minute_or_normal_boats_it_is_the_start(constant):
    brief = flockenv.simulate(PARAMETERS, 1, 59.0)
    assert decisive_minute([brief]) == (0.0, "")
    assert decisive_minute([constant, brief]) == (0.0, "")
    alone = flockenv.simulate(PARAMETERS.replace(n_boats=1), 1, 100.0)
    assert decisive_minute([alone]) == (0.0, "")


def test_order_towards_the_target_comes_first_where_there_are_leaders(constant):
    free = flockenv.simulate(PARAMETERS.replace(n_leaders=0), 1, 1.0)
    keys = [each["key"] for each in shown_quantities([constant])]
    assert keys == ["signed_order", "rotation", *ORDER]
    assert [each["key"] for each in shown_quantities([free])] == ["rotation", *ORDER]
    assert shown_quantities([free, constant])[0]["key"] == "signed_order"


def test_digits_follow_the_size_of_the_numbers(constant):
    decimals = {each["key"]: each["decimals"] for each in shown_quantities([constant])}
    assert decimals["psi_o"] == 2
    for key, digits in decimals.items():
        largest = np.abs(series_of(constant, key)).max()
        assert 10.0**-digits / 20 <= max(largest, 1e-3) / 100
