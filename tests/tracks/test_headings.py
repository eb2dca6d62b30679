"""Headings of any convention are directions in the pool, and axes are none."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, read_tracks

from .conftest import LAYOUT, but, read_and_counted

UP = {"x": "x_cm", "y": "y_cm", "cm_per_unit": 1.0, "center": (0.0, 0.0), "y_down": False}


def world(seen):
    """The table in cm with y up, and headings in degrees counter-clockwise from x."""
    table = seen.table.assign(
        x_cm=(seen.table["x_px"] - LAYOUT.center[0]) * LAYOUT.cm_per_unit,
        y_cm=-(seen.table["y_px"] - LAYOUT.center[1]) * LAYOUT.cm_per_unit,
    )
    return table.assign(angle=-table["angle"] % 360)


@pytest.mark.parametrize(
    ("angle", "fields"),
    [
        (lambda a: (90 - a) % 360, {"heading_zero": "up", "heading_turns": "cw"}),
        (lambda a: -a % 360, {"heading_turns": "cw"}),
        (lambda a: (a + 90) % 360, {"heading_zero": "down"}),
        (lambda a: (a - 180) % 360, {"heading_zero": "left", "heading_turns": "ccw"}),
        (lambda a: (a + 180) % 360 - 180, {}),
        (lambda a: np.radians(a), {"heading_unit": "rad"}),
        (lambda a: a + 720 * (a > 90), {"wrapped": False}),
    ],
)
def test_conventions_of_headings(seen, angle, fields):
    table = world(seen).assign(angle=lambda table: angle(table["angle"]))
    found, report = read_and_counted(table, but(LAYOUT, **UP, **fields))
    expected = read_tracks(seen.table, LAYOUT)
    assert np.allclose(found.order.psi_o, expected.order.psi_o, atol=1e-9, equal_nan=True)
    assert report.cosine > 0.6


@pytest.mark.parametrize("down", [False, True])
def test_a_compass_in_a_picture_points_up(seen, down):
    """As the picture shows it: whichever way y counts, north is up and angles grow clockwise."""
    table = seen.table.assign(angle=(seen.table["angle"] + 90) % 360)
    table = table if down else table.assign(y_px=1209 - table["y_px"])
    found = read_tracks(table, but(LAYOUT, y_down=down, heading_zero="up", heading_turns="cw"))
    expected = read_tracks(seen.table, LAYOUT)
    assert np.allclose(found.order.psi_o, expected.order.psi_o, atol=1e-9, equal_nan=True)


@pytest.mark.parametrize(
    ("change", "fields"),
    [
        (lambda t: t.assign(angle=-t["angle"] % 360), {}),
        (lambda t: t.assign(angle=(t["angle"] + 180) % 360), {}),
        (lambda t: t.rename(columns={"x_px": "y_px", "y_px": "x_px"}), {"center": (604.5, 812.0)}),
        (lambda t: t, {"heading_turns": "ccw"}),
        (lambda t: t, {"heading_zero": "down"}),
        (lambda t: t.assign(angle=np.random.default_rng(0).uniform(0, 360, len(t))), {}),
    ],
)
def test_a_wrong_direction_shows_in_the_cosine(seen, change, fields):
    _, report = read_and_counted(change(seen.table), but(LAYOUT, **fields))
    assert report.cosine < 0.3
    assert "far from 1: are y_down, heading_unit" in str(report)


@pytest.mark.parametrize(
    "axis", [lambda a: a % 180, lambda a: (a + 90) % 180 - 90, lambda a: a % 180 - 180]
)
def test_axes_are_no_directions(seen, axis):
    table = seen.table.assign(angle=axis(seen.table["angle"]))
    for changes in ({}, {"heading_unit": "rad"}):
        data = table if not changes else table.assign(angle=np.radians(table["angle"]))
        with pytest.raises(flockenv.ParameterError, match="axis = true"):
            read_tracks(data, but(LAYOUT, **changes))
    found, report = read_and_counted(table, but(LAYOUT, axis=True))
    expected = read_tracks(seen.table, LAYOUT)
    assert report.cosine > 0.6
    # Boats back up now and then, and gaps start the search anew: most bows are where they were.
    error = np.cos(found.pose[..., 2] - expected.pose[..., 2])
    assert np.nanmean(error > 0.9) > 0.97


@pytest.mark.parametrize(
    ("change", "fields", "words"),
    [
        (np.radians, {}, "in rad, and fit the motion better than in deg"),
        (lambda a: a / 360, {}, "never exceed a full turn in turn,"),
        (
            lambda a: (a + 180) % 360 / 360 - 0.5,
            {"heading_unit": "rad"},
            "is heading_unit = 'turn'?",
        ),
        (np.radians, {"heading_unit": "turn"}, "heading_unit = 'rad' if they are in rad, "),
        (lambda a: a, {"heading_unit": "rad"}, "heading_unit = 'deg' if they are in deg,"),
        (lambda a: a * 10, {}, "wrapped = false if they count whole turns"),
        (lambda a: a * 10, {"heading_unit": "rad"}, "exceed a full turn in rad: wrapped"),
    ],
)
def test_headings_of_another_unit_are_refused(seen, change, fields, words):
    table = seen.table.assign(angle=change(seen.table["angle"]))
    with pytest.raises(flockenv.ParameterError) as raised:
        read_tracks(table, but(LAYOUT, **fields))
    assert words in str(raised.value)
    assert ("'deg'" in str(raised.value)) == ("'deg'" in words)


@pytest.mark.parametrize("backward", [False, True])
def test_a_unit_larger_than_the_right_one_is_not_advised(backward):
    """Headings that go on for rounds are below a turn in rad; in turns they are whole turns."""
    k = np.arange(400)
    angle = 0.07 * k
    turns = (angle / (2 * np.pi) + 0.25 + 0.5 * backward) % 1.0
    table = pd.DataFrame({"frame": k, "id": "a", "x": 60 * np.cos(angle), "y": 60 * np.sin(angle)})
    layout = TrackLayout(pool=(100.0, 0.0), fps=10.0, heading_unit="turn")
    _, report = read_and_counted(table.assign(heading=turns), layout)
    assert report.cosine == pytest.approx(-1.0 if backward else 1.0, abs=1e-4)


def test_boats_that_head_one_way_in_degrees_are_read():
    k = np.arange(60)
    table = pd.DataFrame({"frame": k, "id": "a", "x": k - 30.0, "y": 0.0, "heading": k % 6 - 2.5})
    layout = TrackLayout(pool=(90.0, 0.0), fps=10.0, heading_unit="deg")
    assert read_and_counted(table, layout)[1].cosine > 0.99


@pytest.mark.parametrize("value", [np.inf, 999.0, -1e10])
def test_a_few_strange_headings_are_left_out_and_not_advised_about(seen, value):
    radians = seen.table.assign(angle=np.radians(seen.table["angle"]))
    table = radians.copy()
    table.loc[::300, "angle"] = value
    found, report = read_and_counted(table, but(LAYOUT, heading_unit="rad"))
    assert sum(sum(each.values()) for each in report.left_out.values()) == len(table[::300])
    kept = radians[np.arange(len(radians)) % 300 != 0]
    assert found == read_tracks(kept, but(LAYOUT, heading_unit="rad"))
