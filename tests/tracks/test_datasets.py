"""Law: a dataset of movement is read as directly as a table, or what it lacks is named.

test_honest_tables.py has the datasets that are read.
"""

import numpy as np
import pytest
import xarray

import flockenv
from flockenv.tracks import TrackLayout, read_tracks

from .conftest import but
from .honest import PLACE
from .program_tables import boxes, movement

LAYOUT = TrackLayout(**PLACE)


def test_a_dataset_and_the_table_that_it_makes_are_one_recording():
    dataset = movement()
    table = dataset["position"].to_series().unstack(["keypoints", "space"])
    table.columns = ["_".join(each) for each in table.columns]
    layout = but(
        LAYOUT,
        frame="time",
        id="individuals",
        x=("tail_x", "nose_x"),
        y=("tail_y", "nose_y"),
        heading=("tail_x", "tail_y", "nose_x", "nose_y"),
    )
    assert read_tracks(table.reset_index(), layout) == read_tracks(dataset, LAYOUT)


def test_low_confidence_counts_as_missing():
    dataset = movement()
    dataset["confidence"][30:40, 0, 2] = 0.1
    sure = {"confidence": ("nose_confidence",), "least_confidence": 0.6}
    reports = []
    read_tracks(dataset, but(LAYOUT, **sure), reports.append)
    assert reports[0].left_out == {"with too little confidence": {"id_2": 10}}


def test_a_selected_individual_keeps_its_name():
    one = movement().sel(individuals="id_2")
    for dataset in (one, one.rename(individuals="individual")):
        assert read_tracks(dataset, LAYOUT).ids.tolist() == ["id_2"]


def renamed(dataset, dimension, names):
    return dataset.assign_coords({dimension: names})


@pytest.mark.parametrize(
    ("dataset", "changes", "words"),
    [
        (lambda: movement().sel(keypoints=["nose"]), {}, "no headings: its key points are nose"),
        (boxes, {}, "no headings: its key points are one"),
        (
            lambda: renamed(movement(), "keypoints", ["left", "right"]),
            {},
            "no headings: its key points are left, right; name those of tail and head in heading",
        ),
        (
            lambda: renamed(movement(), "individuals", ["a", "b", "a", "c", "d", "e"]),
            {},
            "2 individuals of the dataset are called 'a'",
        ),
        (
            lambda: renamed(movement(), "keypoints", ["nose", "nose"]),
            {},
            "2 keypoints of the dataset are called 'nose'",
        ),
        (
            lambda: renamed(movement(), "keypoints", ["left", "right"]),
            {"heading": None},
            "which of the key points left, right is the center is not known: name its columns in x",
        ),
        (movement, {"cm_per_unit": None}, "in pixels: cm_per_unit, the length of one, is missing"),
        (
            lambda: movement().assign(
                position=lambda d: d["position"].assign_attrs(space_unit="bananas")
            ),
            {"cm_per_unit": None},
            "in bananas: cm_per_unit",
        ),
        (lambda: movement(fps=None), {}, "in frames: fps is missing"),
        (lambda: movement(fps=None, time_unit="seconds"), {}, "fps is missing: column 'time'"),
        (lambda: movement().drop_vars("position"), {}, "no variable 'position'; there are conf"),
        (lambda: movement().rename(time="t"), {}, "position has the dimensions"),
        (lambda: renamed(movement(), "space", ["x", "z"]), {}, "position has no y in space"),
        (lambda: movement().drop_vars("time"), {}, "position has the dimensions"),
        (lambda: movement().expand_dims("view"), {}, "has the dimensions view, time"),
        (lambda: xarray.Dataset(), {}, "no variable 'position'"),
        (lambda: movement() * np.nan, {}, "no row has a name, a position"),
        (movement, {"heading": "angle"}, "column 'angle' is missing; there are time, individuals"),
        (movement, {"center": (0.0, 0.0)}, "of the centers lie outside the pool"),
    ],
)
def test_what_a_dataset_lacks_is_named(dataset, changes, words):
    with pytest.raises(flockenv.ParameterError) as raised:
        read_tracks(dataset(), but(LAYOUT, **changes))
    assert words in str(raised.value)


def test_a_dataset_needs_a_layout():
    with pytest.raises(flockenv.ParameterError, match="layout is missing"):
        read_tracks(movement())


def test_what_the_layout_says_counts_more_than_what_is_found():
    found = read_tracks(movement(), but(LAYOUT, x="nose_x", y="nose_y"))
    middle = read_tracks(movement(), LAYOUT)
    ahead = np.hypot(*(found.pose - middle.pose)[..., :2].reshape(-1, 2).T)
    # Half of a body of 40 pixels.
    assert ahead == pytest.approx(20 * PLACE["cm_per_unit"], abs=1e-9)


def test_a_key_point_that_is_called_like_a_boat_names_none():
    dataset = renamed(movement(), "keypoints", ["center", "body"]).drop_vars("confidence")
    found = read_tracks(dataset, but(LAYOUT, heading=None))
    assert found.ids.tolist() == movement()["individuals"].values.tolist()
    assert found == read_tracks(movement(), but(LAYOUT, heading=None, x="nose_x", y="nose_y"))


def test_three_dimensions_are_seen_from_above():
    dataset = movement()
    place = dataset["position"]
    flat = place.isel(space=[0]).assign_coords(space=["z"]) * 0.0
    deep = dataset.drop_dims("space").assign(position=xarray.concat([flat, place], "space"))
    assert read_tracks(deep, LAYOUT) == read_tracks(dataset, LAYOUT)
