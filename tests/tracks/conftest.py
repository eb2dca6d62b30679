"""Tracks whose truth is known: a simulated flock, seen by a camera."""

import dataclasses
from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, guess_layout, read_layout, read_tracks

PIXEL_CM = 0.25
CENTER = (812.0, 604.5)
PARAMETERS = flockenv.FlockParameters(n_boats=20, n_leaders=2, pool="narrow", bw_s=0.3)
FIELDS = {"pool": "narrow", "leaders": ("boat1", "boat2"), "cm_per_unit": PIXEL_CM}
FIELDS |= {"center": CENTER, "y_down": True, "heading_unit": "deg"}
LAYOUT = TrackLayout(**FIELDS, fps=10.0, id="track", x="x_px", y="y_px", heading="angle")


@dataclass
class Seen:
    """A run, and the table that a tracker of a camera makes of it."""

    truth: flockenv.Recording
    table: pd.DataFrame
    missing: int


@pytest.fixture(scope="session")
def seen() -> Seen:
    """Positions in whole pixels of 2.5 mm, y down, 0.3 % of the rows missing."""
    truth = flockenv.simulate(PARAMETERS, 5, 60.0)
    table = truth.to_dataframe(boats=True)
    rows = pd.DataFrame(
        {
            "frame": np.rint(table["time_s"] * 10).astype(int),
            "track": "boat" + (table["boat"] + 1).astype(str),
            "x_px": np.rint(table["x_cm"] / PIXEL_CM + CENTER[0]),
            "y_px": np.rint(-table["y_cm"] / PIXEL_CM + CENTER[1]),
            "angle": np.rint(-np.degrees(table["heading_rad"])) % 360,
        }
    )
    dropped = np.random.default_rng(1).random(len(rows)) < 0.003
    return Seen(truth, rows[~dropped].reset_index(drop=True), int(dropped.sum()))


def read_and_counted(source, layout=None):
    """Return the recording of tracks and the report of what was left out."""
    reports = []
    recording = read_tracks(source, layout, reports.append)
    (report,) = reports
    return recording, report


def guessed_of(path):
    """Return the layout that is guessed from a table, as the file beside it says it."""
    guess_layout(path)
    return read_layout(path.with_suffix(".toml"))


def but(layout, **changes):
    """Return a layout with other values in some of its fields."""
    return dataclasses.replace(layout, **changes)


def check(seen, found, report, tolerance=1e-6):
    expected = read_tracks(seen.table, LAYOUT)
    order = [expected.ids.tolist().index(name) for name in found.ids]
    there = ~np.isnan(found.pose[..., 0])
    assert (report.samples, report.missing) == (len(seen.table), seen.missing)
    assert np.abs((found.pose - expected.pose[:, order])[there][:, :2]).max() < tolerance
    assert np.allclose(found.order.psi_o, expected.order.psi_o, atol=1e-5, equal_nan=True)
