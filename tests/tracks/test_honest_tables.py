"""Law: tables as the programs of the field write them are read, and give back the flock.

Each table is written from one simulated flock by a description of a convention: a program's
columns, an order of rows, a clock, a spelling, a convention of headings, marks of lost animals.
"""

import gzip
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray

from flockenv import FlockParameters, Recording, simulate
from flockenv.tracks import TrackLayout, guess_layout, read_layout, read_tracks

BOATS, FRAMES, HZ, PIXEL_CM, CENTER = 6, 150, 10.0, 0.25, (420.0, 390.0)
#: What a table in pixels needs, whatever its columns are called.
PLACE = {"pool": "narrow", "cm_per_unit": PIXEL_CM, "center": CENTER, "y_down": True}
#: Pictures count y downwards, and angles from x to y.
ANGLE = {"heading": "angle", "heading_unit": "deg"}
Rows = pd.DataFrame


@cache
def truth() -> Recording:
    return simulate(FlockParameters(n_boats=BOATS, pool="narrow", bw_s=0.2), 4, FRAMES / HZ)


@cache
def _rows() -> Rows:
    table = truth().to_dataframe(boats=True)
    angle = table["heading_rad"].to_numpy()
    rows = pd.DataFrame(
        {
            "frame": np.rint(table["time_s"] * HZ).astype(int),
            "id": table["boat"] + 1,
            "x": table["x_cm"] / PIXEL_CM + CENTER[0],
            "y": -table["y_cm"] / PIXEL_CM + CENTER[1],
            "angle": -np.degrees(angle) % 360,
        }
    )
    turn = np.radians(rows["angle"])
    for name, sign in (("nose", 1), ("tail", -1)):
        rows[f"{name}_x"] = rows["x"] + sign * 20 * np.cos(turn)
        rows[f"{name}_y"] = rows["y"] + sign * 20 * np.sin(turn)
    return rows


def rows() -> Rows:
    """One row per frame and boat, in pixels, y down, degrees from x to y."""
    return _rows().copy()


@dataclass
class Honest:
    """A table of a convention: what to write, and the layout that a user would give."""

    table: Callable[[], Any]
    layout: Mapping[str, Any]
    name: str = "tracks.csv"
    options: Mapping[str, Any] = field(default_factory=dict)
    #: Whether headings are those of the boats; otherwise places and speeds are compared.
    has_headings: bool = True
    boats: tuple[int, ...] = tuple(range(1, BOATS + 1))


def wide(column: Callable[[str, Any], str], names: tuple[str, ...] = ("x", "y")) -> Rows:
    """One row per frame: the columns of each boat beside each other."""
    parts = {
        column(name, boat): own.set_index("frame")[name]
        for boat, own in rows().groupby("id")
        for name in names
    }
    return pd.DataFrame(parts).reset_index()


def deeplabcut(several: bool, parts: tuple[str, ...] = ("nose", "tail")) -> Rows:
    columns = {}
    for boat, own in rows().set_index("frame").groupby("id"):
        if not several and boat != 1:
            continue
        for part in parts:
            for coord in ("x", "y", "likelihood"):
                values = own.get(f"{part}_{coord}", own["x"] * 0 + 0.98)
                levels = (f"fish{boat}", part) if several else (part,)
                columns["DLC_resnet50_model", *levels, coord] = values
    table = pd.DataFrame(columns)
    levels = ["individuals", "bodyparts"] if several else ["bodyparts"]
    table.columns.names = ["scorer", *levels, "coords"]
    table.index.name = None
    return table


def sleap(named: bool = True) -> Rows:
    table = rows() if named else rows()[rows()["id"] == 1]
    found = pd.DataFrame({"track": "track_" + table["id"].astype(str), "frame_idx": table["frame"]})
    found["track"] = found["track"] if named else np.nan
    found["instance.score"] = 0.97
    for part in ("nose", "tail"):
        found[f"{part}.x"], found[f"{part}.y"] = table[f"{part}_x"], table[f"{part}_y"]
        found[f"{part}.score"] = 0.9
    return found


def trex(lost: Any = np.inf) -> Rows:
    table = rows()
    found = pd.DataFrame({"frame": table["frame"], "missing": 0, "time": table["frame"] / HZ})
    found["X#wcentroid (cm)"] = table["x"] * PIXEL_CM
    found["Y#wcentroid (cm)"] = table["y"] * PIXEL_CM
    found["ANGLE"], found["SPEED#wcentroid (cm/s)"] = np.radians(table["angle"]), 1.0
    found["id"] = "fish" + (table["id"] - 1).astype(str)
    found.loc[5::100, [n for n in found if "#" in n or n == "ANGLE"]] = lost
    return found


def mot(columns: int) -> str:
    table = rows()
    found = pd.DataFrame({"frame": table["frame"] + 1, "id": table["id"]})
    found["l"], found["t"], found["w"], found["h"] = table["x"] - 15, table["y"] - 9, 30, 18
    for name in ("conf", "x", "y", "z")[: columns - 6]:
        found[name] = 1 if name == "conf" else -1
    return found.to_csv(index=False, header=False)


MOT = ["frame", "id", "bb_left", "bb_top", "bb_width", "bb_height", "conf", "x", "y", "z"]


def trackmate(lines: int) -> str:
    table = rows()
    found = pd.DataFrame({"LABEL": "ID1", "ID": range(len(table)), "TRACK_ID": table["id"]})
    found["QUALITY"], found["POSITION_X"], found["POSITION_Y"] = 7.5, table["x"], table["y"]
    found["POSITION_T"], found["FRAME"] = table["frame"] / HZ, table["frame"]
    header, rest = found.to_csv(index=False).split("\n", 1)
    more = ["Label,Spot ID,Track ID,Quality,X,Y,T,Frame"] * 2 + [
        ",,,(quality),(pixel),(pixel),(sec),"
    ]
    return "\n".join([header, *more[:lines], rest])


def quaternions() -> Rows:
    """In m, y up, with the boats rolled about their length, as ROS writes them."""
    table = rows()
    found = table[["frame", "id"]].copy()
    found["x"] = (table["x"] - CENTER[0]) * PIXEL_CM / 100
    found["y"] = -(table["y"] - CENTER[1]) * PIXEL_CM / 100
    half, tilt = -np.radians(table["angle"]) / 2, 0.2
    for name, value in {
        "qx": tilt * np.cos(half),
        "qy": tilt * np.sin(half),
        "qz": np.sin(half),
        "qw": np.cos(half),
    }.items():
        found[name] = value / np.hypot(1, tilt)
    return found


METERS = {"pool": "narrow", "cm_per_unit": 100.0}


def ros(prefix: str, time: str) -> Rows:
    table = quaternions()
    found = pd.DataFrame({time: 1_700_000_000_000_000_000 + table["frame"] * 100_000_000})
    found[f"{prefix}header.seq"] = table["frame"]
    for axis in "xyz":
        found[f"{prefix}pose.position.{axis}"] = table.get(axis, 0.0)
    for axis in "xyzw":
        found[f"{prefix}pose.orientation.{axis}"] = table[f"q{axis}"]
    return found.assign(robot=table["id"])


def motive() -> str:
    """Rigid bodies beside each other, with the vertical axis Y, in levels of header."""
    table = quaternions()
    groups = [(f"robot{boat}", own.set_index("frame")) for boat, own in table.groupby("id")]
    kinds = [("Rotation", axis) for axis in "XYZW"] + [("Position", axis) for axis in "XYZ"]
    kinds += [("Mean Marker Error", "")]
    values: list[Any] = []
    for _, own in groups:
        # X stays, Y is up, and Z points at the viewer's feet.
        values += [own["qx"], own["qz"], -own["qy"], own["qw"]]
        values += [own["x"], 0 * own["x"] + 0.1, -own["y"], 0 * own["x"] + 0.0002]
    first = (
        "Format Version,1.23,Take Name,t,Capture Frame Rate,10.000000,Export Frame Rate,10.000000"
    )
    first += ",Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global"
    names = [name for name, _ in groups for _ in kinds]
    lines = [first, "", ",Type," + ",".join(["Rigid Body"] * len(names))]
    lines += [",Name," + ",".join(names), ",ID," + ",".join(["ABC"] * len(names))]
    lines += [",," + ",".join(kind for _ in groups for kind, _ in kinds)]
    lines += ["Frame,Time (Seconds)," + ",".join(axis for _ in groups for _, axis in kinds)]
    body = pd.DataFrame(dict(enumerate(values)))
    body.insert(0, "t", body.index / HZ)
    return "\n".join(lines) + "\n" + body.to_csv(header=False, lineterminator="\n")


def movement(
    dims: tuple[str, ...] = ("time", "space", "keypoints", "individuals"),
    fps: float | None = HZ,
    unit: str | None = None,
    **attributes: Any,
) -> xarray.Dataset:
    """A dataset of poses, as `movement` makes it."""
    table, points = rows(), ["nose", "tail"]
    scale = 1.0 if unit is None else {"cm": PIXEL_CM, "mm": 10 * PIXEL_CM}[unit]
    cube = np.stack(
        [[table[f"{p}_{c}"].to_numpy().reshape(-1, BOATS) * scale for p in points] for c in "xy"]
    ).transpose(2, 0, 1, 3)
    time = np.arange(len(cube)) / (fps or 1.0) if fps else np.arange(len(cube))
    coords = {"time": time, "space": ["x", "y"], "keypoints": points}
    coords["individuals"] = [f"id_{n}" for n in range(BOATS)]
    order = ("time", "space", "keypoints", "individuals")
    position = xarray.DataArray(cube, coords, order, attrs={"space_unit": unit} if unit else {})
    confidence = xarray.ones_like(position.isel(space=0, drop=True)) * 0.9
    said = {"source_software": "SLEAP", "ds_type": "poses"}
    said |= {"time_unit": "seconds" if fps else "frames"} | ({"fps": fps} if fps else {})
    dataset = xarray.Dataset({"position": position, "confidence": confidence}, attrs=said)
    plural = {"individual": "individuals", "keypoint": "keypoints"}
    dataset = dataset.rename({plural[n]: n for n in dims if n in plural}).transpose(*dims)
    return dataset.assign_attrs(attributes)


def boxes() -> xarray.Dataset:
    """Bounding boxes: no key points, and the size of each box."""
    dataset = movement().mean("keypoints")
    return dataset.assign(shape=xarray.full_like(dataset["position"], 30.0))


SIDES = {"heading": ("tail_x", "tail_y", "nose_x", "nose_y")}
MIDDLE = {"x": ("tail_x", "nose_x"), "y": ("tail_y", "nose_y"), **SIDES}


def ids(prefix: str, **fields: Any) -> dict[str, Any]:
    return {**PLACE, "fps": HZ, **fields}


def dotted(fields: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    return {name: tuple(f"{prefix}{each}" for each in names) for name, names in fields.items()}


DLC = {**PLACE, "fps": HZ, "confidence": ("nose_likelihood", "tail_likelihood")}
DLC |= {"least_confidence": 0.6}
SLEAP_COLUMNS = {name: tuple(c.replace("_", ".") for c in each) for name, each in MIDDLE.items()}

PROGRAMS: dict[str, Honest] = {
    "TRex": Honest(
        trex,
        {"pool": "narrow", "center": [c * PIXEL_CM for c in CENTER], "y_down": True}
        | {"frame": "time", "x": "X#wcentroid (cm)", "y": "Y#wcentroid (cm)", "heading": "ANGLE"},
    ),
    "TRex by frames, empty cells": Honest(
        lambda: trex(np.nan),
        {"pool": "narrow", "center": [c * PIXEL_CM for c in CENTER], "y_down": True, "fps": HZ}
        | {"x": "X#wcentroid (cm)", "y": "Y#wcentroid (cm)", "heading": "ANGLE"},
    ),
    "idtracker.ai": Honest(
        lambda: (
            wide(lambda n, b: f"{n}{b}")
            .assign(frame=lambda t: t["frame"] / HZ)
            .rename(columns={"frame": "seconds"})
        ),
        {**PLACE, "frame": "seconds", "x": "x{id}", "y": "y{id}", "heading": None},
        has_headings=False,
    ),
    "idtracker.ai with angles": Honest(
        lambda: wide(lambda n, b: f"{n}{b}", ("x", "y", "angle")),
        {**PLACE, **ANGLE, "fps": HZ, "x": "x{id}", "y": "y{id}", "heading": "angle{id}"},
    ),
    "UMATracker": Honest(
        lambda: wide(lambda n, b: f"{n}{b - 1}").rename(columns={"frame": "position"}),
        {**PLACE, "frame": "position", "fps": HZ, "x": "x{id}", "y": "y{id}", "heading": None},
        has_headings=False,
    ),
    "AnimalTA": Honest(
        lambda: wide(lambda n, b: f"{n.upper()}_Arena0_Ind{b}").assign(
            Time=lambda t: t["frame"] / HZ
        ),
        {**PLACE, "frame": "Time", "x": "X_{id}", "y": "Y_{id}", "heading": None, "separator": ";"},
        options={"sep": ";"},
        has_headings=False,
    ),
    "DLTdv": Honest(
        lambda: wide(lambda n, b: f"pt{b}_cam1_{n.upper()}"),
        {**PLACE, "fps": HZ, "x": "{id}_cam1_X", "y": "{id}_cam1_Y", "heading": None},
        has_headings=False,
    ),
    "DeepLabCut of one animal": Honest(
        lambda: deeplabcut(False),
        {**DLC, **MIDDLE, "id": None},
        boats=(1,),
        options={"index": True},
    ),
    "DeepLabCut of several animals": Honest(
        lambda: deeplabcut(True),
        {**PLACE, "fps": HZ, **dotted(MIDDLE, "{id}."), "least_confidence": 0.6}
        | {"confidence": ("{id}.nose_likelihood", "{id}.tail_likelihood")},
        options={"index": True},
    ),
    "SLEAP": Honest(
        sleap, {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS}
    ),
    "SLEAP of one animal, by NumPy": Honest(
        lambda: sleap(named=False).assign(track="nan"),
        {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS},
        boats=(1,),
    ),
    "SLEAP of one animal": Honest(
        lambda: sleap(named=False),
        {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS},
        boats=(1,),
    ),
    **{
        f"MOT of {count} columns": Honest(
            lambda count=count: mot(count),
            {**PLACE, "fps": HZ, "header": MOT[:count], "x": "bb_left", "y": "bb_top"}
            | {"box": ("bb_width", "bb_height"), "heading": None},
            name="gt.txt",
            has_headings=False,
        )
        for count in (6, 7, 9, 10)
    },
    **{
        f"TrackMate with {lines} more lines": Honest(
            lambda lines=lines: trackmate(lines),
            {**PLACE, "frame": "POSITION_T", "id": "TRACK_ID", "x": "POSITION_X"}
            | {"y": "POSITION_Y", "heading": None},
            has_headings=False,
        )
        for lines in (0, 3)
    },
    "Trackpy": Honest(
        lambda: (
            rows()[["y", "x", "frame", "id"]]
            .assign(mass=100.0, ecc=0.1)
            .rename(columns={"id": "particle"})
        ),
        {**PLACE, "fps": HZ, "id": "particle", "heading": None},
        has_headings=False,
        options={"index": True},
    ),
    "ROS 1 bag": Honest(
        lambda: ros("field.", "%time"),
        {**METERS, "frame": "%time", "fps": 1e9, "id": "robot", "x": "field.pose.position.x"}
        | {"y": "field.pose.position.y"}
        | {"quaternion": [f"field.pose.orientation.{axis}" for axis in "xyzw"]},
    ),
    "ROS 2 bag": Honest(
        lambda: ros("/odom/pose.", "rosbagTimestamp"),
        {**METERS, "frame": "rosbagTimestamp", "fps": 1e9, "id": "robot"}
        | {"x": "/odom/pose.pose.position.x", "y": "/odom/pose.pose.position.y"}
        | {"quaternion": [f"/odom/pose.pose.orientation.{axis}" for axis in "xyzw"]},
    ),
    "motion capture with quaternions": Honest(
        quaternions, {**METERS, "fps": HZ, "quaternion": ["qx", "qy", "qz", "qw"]}
    ),
    "MOT with a header": Honest(
        lambda: ",".join(MOT) + "\n" + mot(10),
        {**PLACE, "fps": HZ, "x": "bb_left", "y": "bb_top", "box": ("bb_width", "bb_height")}
        | {"heading": None},
        has_headings=False,
    ),
    "OptiTrack Motive": Honest(
        motive,
        {**METERS, "frame": "Time (Seconds)", "y_down": True, "heading_turns": "ccw", "skip": 2}
        | {"x": "{id}.Position_X", "y": "{id}.Position_Z"}
        | {"quaternion": [f"{{id}}.Rotation_{axis}" for axis in "XZYW"]},
    ),
    "EthoVision": Honest(
        lambda: (
            'Number of header lines:;"3"\nExperiment;circle\n\n'
            + rows()[rows()["id"] == 1]
            .assign(t=lambda t: t["frame"] / HZ)[["t", "x", "y", "angle"]]
            .to_csv(
                sep=";", index=False, header=["Trial time", "X center", "Y center", "Direction"]
            )
            .replace("Direction\n", "Direction\ns;px;px;deg\n")
        ),
        {**PLACE, "frame": "Trial time", "id": None, "x": "X center", "y": "Y center"}
        | {"heading": "Direction", "heading_unit": "deg", "separator": ";", "skip": 3},
        boats=(1,),
    ),
    "BioTracker": Honest(
        lambda: rows()[["frame", "id", "x", "y", "angle"]].set_axis(
            ["FRAME", "ID", "xpx", "ypx", "deg"], axis=1
        ),
        {**PLACE, "fps": HZ, "x": "xpx", "y": "ypx", "heading": "deg", "heading_unit": "deg"},
    ),
    "Tracktor": Honest(
        lambda: rows()[["frame", "x", "y", "id"]].set_axis(
            ["frame", "pos_x", "pos_y", "id"], axis=1
        ),
        {**PLACE, "fps": HZ, "x": "pos_x", "y": "pos_y", "heading": None},
        options={"index": True},
        has_headings=False,
    ),
    "ToxTrac": Honest(
        lambda: rows()[["frame", "id", "x", "y"]].set_axis(["Frame", "Track", "X", "Y"], axis=1),
        {**PLACE, "fps": HZ, "id": "Track", "heading": None, "separator": "\t"},
        name="Tracking.txt",
        options={"sep": "\t"},
        has_headings=False,
    ),
    "celltrackR": Honest(
        lambda: rows()[["id", "frame", "x", "y"]].set_axis(["id", "t", "x", "y"], axis=1),
        {**PLACE, "frame": "t", "fps": HZ, "heading": None, "separator": " "},
        name="tracks.txt",
        options={"sep": " "},
        has_headings=False,
    ),
    "Fiji's manual tracking": Honest(
        lambda: rows()[["id", "frame", "x", "y"]].set_axis(
            ["Track n°", "Slice n°", "X", "Y"], axis=1
        ),
        {**PLACE, "fps": HZ, "id": "Track n°", "frame": "Slice n°", "heading": None},
        options={"index": True, "encoding": "cp1252"},
        has_headings=False,
    ),
    "AprilTags": Honest(
        lambda: (
            rows()
            .assign(timestamp=lambda t: 1.7e9 + t["frame"] / HZ)[
                ["timestamp", "id", "x", "y", "angle"]
            ]
            .rename(columns={"id": "tag_id", "angle": "yaw"})
        ),
        {**PLACE, "frame": "timestamp", "id": "tag_id", "heading": "yaw", "heading_unit": "deg"},
    ),
    "ArUco log in mm": Honest(
        lambda: rows().assign(
            time_ms=lambda t: t["frame"] * 100,
            x_mm=lambda t: t["x"] * 2.5,
            y_mm=lambda t: t["y"] * 2.5,
        )[["time_ms", "id", "x_mm", "y_mm", "angle"]],
        {"pool": "narrow", "cm_per_unit": 0.1, "center": [c * 2.5 for c in CENTER], "y_down": True}
        | {"frame": "time_ms", "fps": 1000.0, "x": "x_mm", "y": "y_mm", **ANGLE},
    ),
    "VGG Image Annotator": Honest(
        lambda: rows().assign(left=lambda t: t["x"] - 8, top=lambda t: t["y"] - 8, w=16, h=16),
        {**PLACE, "fps": HZ, "x": "left", "y": "top", "box": ("w", "h"), **ANGLE},
    ),
    "NetLogo": Honest(
        lambda: (
            "BehaviorSpace results\nflock.nlogo\n\n"
            + rows().assign(heading=lambda t: (t["angle"] + 90) % 360).to_csv(index=False)
        ),
        {**PLACE, "fps": HZ, "heading_unit": "deg", "heading_zero": "up", "heading_turns": "cw"}
        | {"skip": 3},
    ),
    "flockenv itself": Honest(
        lambda: truth().to_dataframe(boats=True),
        {"pool": "narrow", "frame": "time_s", "id": "boat", "x": "x_cm", "y": "y_cm"}
        | {"heading": "heading_rad", "wrapped": False},
    ),
}
DATASETS: dict[str, Honest] = {
    "in pixels": Honest(movement, PLACE),
    "of an older movement": Honest(
        lambda: movement(("time", "individuals", "keypoints", "space")), PLACE
    ),
    "of a later movement": Honest(
        lambda: movement(("time", "space", "keypoint", "individual")), PLACE
    ),
    "in frames": Honest(lambda: movement(fps=None), {**PLACE, "fps": HZ}),
    "scaled to cm": Honest(
        lambda: movement(unit="cm"),
        {"pool": "narrow", "center": [c * PIXEL_CM for c in CENTER], "y_down": True},
    ),
    "scaled to mm": Honest(
        lambda: movement(unit="mm"),
        {"pool": "narrow", "center": [10 * c * PIXEL_CM for c in CENTER], "y_down": True},
    ),
    "with a confidence": Honest(
        movement,
        {**PLACE, "confidence": ("nose_confidence", "tail_confidence"), "least_confidence": 0.6},
    ),
    "with other columns": Honest(movement, {**PLACE, "x": "nose_x", "y": "nose_y"}, boats=()),
    "of one key point": Honest(
        lambda: movement().sel(keypoints="nose"), {**PLACE, "heading": None}, boats=()
    ),
    "of boxes": Honest(boxes, {**PLACE, "heading": None}, has_headings=False),
    "of one animal": Honest(lambda: movement().sel(individuals=["id_0"]), PLACE, boats=(1,)),
    "filtered": Honest(
        lambda: movement().assign(
            position=lambda d: d["position"].rolling(time=3, center=True, min_periods=1).median()
        ),
        PLACE,
        boats=(),
    ),
}

PLAIN = {**PLACE, **ANGLE, "fps": HZ}
_rng = np.random.default_rng(5)


def _swapped(table: Rows) -> Rows:
    """As a logger with threads writes: neighbors change places."""
    place = np.arange(len(table))
    at = np.arange(3, len(table) - 9, 13)
    place[at], place[at + BOATS] = place[at + BOATS].copy(), place[at].copy()
    return table.iloc[place]


ORDERS: dict[str, Callable[[Rows], Rows]] = {
    "as it was": lambda t: t,
    "by boat": lambda t: t.sort_values(["id", "frame"]),
    "shuffled": lambda t: t.sample(frac=1.0, random_state=1),
    "newest first": lambda t: t[::-1],
    "leaders, then others": lambda t: pd.concat([t[t["id"] <= 2], t[t["id"] > 2]]),
    "late block first": lambda t: pd.concat([t[t["frame"] >= 70], t[t["frame"] < 70]]),
    "neighbors swapped": _swapped,
    "every second frame, then the others": lambda t: pd.concat(
        [t[t["frame"] % 2 == 0], t[t["frame"] % 2 == 1]]
    ),
}
START = pd.Timestamp("2026-03-29 01:59:57")
CLOCKS: dict[str, tuple[Callable[[Any], Any], dict[str, Any]]] = {
    "frames": (lambda s: np.rint(s * HZ).astype(int), {"fps": HZ}),
    "later frames": (lambda s: np.rint(s * HZ).astype(int) + 12345, {"fps": HZ}),
    "every third frame": (lambda s: np.rint(s * 3 * HZ).astype(int), {"fps": 3 * HZ}),
    "frames as decimals": (lambda s: np.rint(s * HZ), {"fps": HZ}),
    "s": (lambda s: s, {"fps": None}),
    "s by fps": (lambda s: s, {"fps": 1.0}),
    "Unix time": (lambda s: s + 1.7e9, {"fps": None}),
    "ms": (lambda s: np.rint(s * 1e3).astype(int), {"fps": 1e3}),
    "ms with decimals": (lambda s: s * 1e3 + 0.02, {"fps": 1e3}),
    "µs": (lambda s: np.rint(s * 1e6).astype(np.int64), {"fps": 1e6}),
    "ns since 1970": (
        lambda s: np.rint(s * 1e9).astype(np.int64) + 1_700_000_000 * 10**9,
        {"fps": 1e9},
    ),
    "minutes": (lambda s: s / 60, {"fps": 1 / 60}),
    "hours": (lambda s: s / 3600, {"fps": 1 / 3600}),
    "dates": (lambda s: START + pd.to_timedelta(s, "s"), {"fps": None}),
    "ISO dates": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ"),
        {"fps": None},
    ),
    "clock": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%H:%M:%S.%f"),
        {"fps": None},
    ),
    "clock past midnight": (
        lambda s: (pd.Timestamp("2026-03-29 23:59:52") + pd.to_timedelta(s, "s")).dt.strftime(
            "%H:%M:%S.%f"
        ),
        {"fps": None},
    ),
    "dates with commas": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%d %H:%M:%S,%f"),
        {"fps": None},
    ),
    "German dates": (
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%d.%m.%Y %H:%M:%S,%f"),
        {"fps": None},
    ),
    "a stopwatch": (
        lambda s: (pd.Timestamp(0) + pd.to_timedelta(s + 50.0, "s")).dt.strftime("%M:%S.%f"),
        {"fps": None},
    ),
    "stamps of each boat": (None, {"fps": None}),
}
SPELLINGS: dict[str, tuple[str, dict[str, Any], dict[str, Any], Callable[[bytes], bytes]]] = {
    "commas": ("t.csv", {}, {}, bytes),
    "semicolons": ("t.csv", {"sep": ";"}, {"separator": ";"}, bytes),
    "a German export": (
        "t.csv",
        {"sep": ";", "decimal": ","},
        {"separator": ";", "decimal": ","},
        bytes,
    ),
    "tabs": ("t.tsv", {"sep": "\t"}, {}, bytes),
    "tabs and decimal commas": ("t.tsv", {"sep": "\t", "decimal": ","}, {"decimal": ","}, bytes),
    "tabs in a text": ("t.txt", {"sep": "\t"}, {"separator": "\t"}, bytes),
    "blanks in a text": ("t.txt", {"sep": " "}, {"separator": " "}, bytes),
    "commas in a text": ("t.txt", {}, {}, bytes),
    "bars": ("t.csv", {"sep": "|"}, {"separator": "|"}, bytes),
    "gzip": ("t.csv.gz", {}, {}, gzip.compress),
    "gzipped tabs": ("t.tsv.gz", {"sep": "\t"}, {}, gzip.compress),
    "gzipped text": ("t.txt.gz", {"sep": ";"}, {"separator": ";"}, gzip.compress),
    "UTF-8 with a mark": ("t.csv", {}, {}, lambda b: b"\xef\xbb\xbf" + b),
    "UTF-16": ("t.csv", {}, {}, lambda b: b.decode().encode("utf-16")),
    "Windows lines": ("T.CSV", {}, {}, lambda b: b.replace(b"\n", b"\r\n")),
    "Macintosh lines": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b"\r")),
    "blank lines": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b"\n\n")),
    "blanks after commas": ("t.csv", {}, {}, lambda b: b.replace(b",", b", ")),
    "Excel's word for it": (
        "t.csv",
        {"sep": ";"},
        {"separator": ";", "skip": 1},
        lambda b: b"sep=;\n" + b,
    ),
    "remarks above": ("t.csv", {}, {"skip": 2}, lambda b: b"# made by a camera\n# 10 Hz\n" + b),
    "a remark mark": ("t.csv", {}, {}, lambda b: b"#" + b),
    "commas at the ends": ("t.csv", {}, {}, lambda b: b.replace(b"\n", b",\n")),
    "quotes": ("t.csv", {"quoting": 1}, {}, bytes),
    "an index": ("t.csv", {"index": True}, {}, bytes),
    "large names": ("t.csv", {}, {}, lambda b: b.split(b"\n")[0].upper() + b[b.index(b"\n") :]),
    "exponents": ("t.csv", {"float_format": "%.9e"}, {}, bytes),
    "no header": (
        "t.csv",
        {"header": False},
        {"header": ["frame", "id", "x", "y", "angle", *(f"p{n}" for n in range(4))]},
        bytes,
    ),
}
DEGREES: dict[str, tuple[Callable[[Any, Any], Any], dict[str, Any]]] = {
    "degrees": (lambda a, t: a, {"heading_unit": "deg"}),
    "signed degrees": (lambda a, t: (a + 180) % 360 - 180, {"heading_unit": "deg"}),
    "radians": (lambda a, t: np.radians(a), {"heading_unit": "rad"}),
    "signed radians": (lambda a, t: np.radians((a + 180) % 360 - 180), {"heading_unit": "rad"}),
    "turns": (lambda a, t: a / 360, {"heading_unit": "turn"}),
    "a compass": (
        lambda a, t: (a + 90) % 360,
        {"heading_unit": "deg", "heading_zero": "up", "heading_turns": "cw"},
    ),
    "mathematics": (lambda a, t: -a % 360, {"heading_unit": "deg", "heading_turns": "ccw"}),
    "from the left": (
        lambda a, t: (a + 180) % 360,
        {"heading_unit": "deg", "heading_zero": "left"},
    ),
    "radians that go on": (
        lambda a, t: np.radians(a + 360 * (t["frame"] // 20)),
        {"heading_unit": "rad", "wrapped": False},
    ),
    "degrees that go on": (
        lambda a, t: a - 360 * (t["frame"] // 20),
        {"heading_unit": "deg", "wrapped": False},
    ),
}
LOST: dict[str, tuple[Any, dict[str, Any]]] = {
    "zeros": (0.0, {"lost": [[0, 0]]}),
    "zeros beside the pool": (0.0, {}),
    "minus one": (-1.0, {"lost": [[-1, -1]]}),
    "nothing": (None, {}),
    "NaN": (np.nan, {}),
    "NA": ("NA", {}),
    "a dash": ("-", {}),
    "infinite": (np.inf, {}),
    "a word": ("lost", {"missing": ["lost"]}),
    "a number": (-999, {"missing": ["-999"]}),
    "no row": ("drop", {}),
}


def _wide_rows(order: str) -> Rows:
    """One row per frame, in an order that a table of one boat would have."""
    one = rows()[rows()["id"] == 1].reset_index(drop=True)
    return wide(lambda n, b: f"{n}{b}", ("x", "y", "angle")).loc[ORDERS[order](one).index]


def _of_order(order: str, names: tuple[str, ...]) -> dict[str, Honest]:
    tables = {
        "long": (lambda: ORDERS[order](rows()), PLAIN),
        "SLEAP": (
            lambda: sleap().loc[ORDERS[order](rows()).index],
            {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS},
        ),
        "s": (
            lambda: ORDERS[order](rows()).assign(frame=lambda t: t["frame"] / HZ),
            {**PLAIN, "fps": None},
        ),
        "wide": (
            lambda: _wide_rows(order),
            {**PLAIN, "x": "x{id}", "y": "y{id}", "heading": "angle{id}"},
        ),
    }
    return {f"{name}: {order}": Honest(*tables[name]) for name in names}


def _with_clock(clock: str) -> Honest:
    times, fields = CLOCKS[clock]

    def table() -> Rows:
        found = rows()
        if times is None:
            return found.assign(frame=found["frame"] / HZ + found["id"] * 0.004)
        return found.assign(frame=times(found["frame"] / HZ))

    return Honest(table, {**PLAIN, **fields})


def _with_lost(mark: str) -> Honest:
    value, fields = LOST[mark]

    def table() -> Rows:
        found = rows().astype({"x": object, "y": object})
        gone = (found["id"] == 3) & found["frame"].between(40, 60)
        if isinstance(value, str) and value == "drop":
            return found[~gone]
        return found.assign(x=found["x"].mask(gone, value), y=found["y"].mask(gone, value))

    return Honest(table, {**PLAIN, **fields})


def _beside_the_pool() -> Rows:
    """A sixth of all detections are reflections outside of the water, each somewhere else."""
    table = rows()
    other = table[::5].assign(x=lambda t: 1200 + t["frame"] * 1.7, y=lambda t: t["id"] * 31.0)
    return pd.concat([table, other.assign(id=99)], ignore_index=True)


def _slow(every_s: float) -> Honest:
    """One picture every so often, of animals that creep along."""
    frame = np.repeat(np.arange(60), 3)
    boat, angle = np.tile(np.arange(3), 60), 0.02 * frame + np.tile([0.0, 2.0, 4.0], 60)
    table = pd.DataFrame({"time_s": frame * every_s, "id": boat})
    table = table.assign(x=70 * np.cos(angle), y=70 * np.sin(angle), heading=angle + np.pi / 2)
    layout = {"pool": (100.0, 0.0), "frame": "time_s", "wrapped": False}
    return Honest(lambda: table, layout, boats=())


def _back_and_forth() -> Rows:
    """On a line: headings are exactly 0 and π, and boats move ahead."""
    frame = np.arange(200)
    phase = frame % 40
    x = np.where(phase < 20, phase, 40 - phase) * 2.0 - 20.0
    heading = np.where(phase < 20, 0.0, np.pi)
    parts = [
        pd.DataFrame({"frame": frame, "id": n, "x": x, "y": 15.0 * n, "heading": heading})
        for n in range(3)
    ]
    return pd.concat(parts)


OTHERS = {
    "a sixth beside the pool": Honest(_beside_the_pool, PLAIN),
    "a picture every 12 s": _slow(12.0),
    "a picture every 30 s": _slow(30.0),
    "a picture every 12.5 s": _slow(12.5),
    "headings 0 and π": Honest(_back_and_forth, {"pool": (100.0, 0.0), "fps": HZ}, boats=()),
    "names as numbers with a point": Honest(lambda: rows().astype({"id": float}), PLAIN),
    "names of two words": Honest(
        lambda: rows().assign(id=lambda t: "fish no. " + t["id"].astype(str)), PLAIN
    ),
    "a column of remarks": Honest(lambda: rows().assign(note='said "no", twice'), PLAIN),
    "columns of the model": Honest(lambda: rows().assign(vx=1.0, vy=2.0, cluster=3), PLAIN),
    "a few rows twice": Honest(lambda: pd.concat([rows(), rows()[::50]]), PLAIN),
}
CORPUS: dict[str, Honest] = {
    **{f"program: {name}": each for name, each in PROGRAMS.items()},
    **{f"dataset {name}": each for name, each in DATASETS.items()},
    **{
        f"order of {name}": each
        for order in ORDERS
        for name, each in _of_order(order, ("long", "SLEAP", "s", "wide")).items()
    },
    **{f"clock: {clock}": _with_clock(clock) for clock in CLOCKS},
    **{
        f"spelling: {name}": Honest(rows, {**PLAIN, **layout}, file, {**options, "bytes": change})
        for name, (file, options, layout, change) in SPELLINGS.items()
    },
    **{
        f"headings: {name}": Honest(
            lambda change=change: rows().assign(angle=lambda t: change(t["angle"], t)),
            {**PLACE, "fps": HZ, "heading": "angle", **fields},
        )
        for name, (change, fields) in DEGREES.items()
    },
    **{f"lost: {mark}": _with_lost(mark) for mark in LOST},
    **{f"other: {name}": each for name, each in OTHERS.items()},
}


def write(honest: Honest, folder: Path) -> Path:
    """Write a table of a convention as its program does."""
    table, options = honest.table(), dict(honest.options)
    change, encoding = options.pop("bytes", bytes), options.pop("encoding", "utf-8")
    if not isinstance(table, str):
        table = table.to_csv(**{"index": False, "lineterminator": "\n", **options})
    path = folder / honest.name
    path.write_bytes(change(table.encode(encoding)))
    return path


def check(honest: Honest, source: Any) -> None:
    layout = {
        n: tuple(map(_tuple, v)) if isinstance(v, list) else v for n, v in honest.layout.items()
    }
    reports: list[Any] = []
    found = read_tracks(source, TrackLayout(**layout), reports.append)
    assert str(reports[0])
    if not honest.boats:  # Another flock than that of the truth, or other points of it.
        assert len(found) > 50
        assert reports[0].broken == 0
        return
    places = found.ids.tolist()
    assert len(places) == len(honest.boats)
    own = truth().pose[: len(found), [boat - 1 for boat in honest.boats]]
    pose = found.pose
    there = ~np.isnan(pose[..., 0])
    start = len(own) - len(pose)
    assert start == 0
    assert there.mean() > 0.9
    assert np.abs((pose - own)[there][:, :2]).max() < 0.01
    if honest.has_headings:
        turn = (pose - own)[there][:, 2]
        assert np.cos(turn).min() > 1 - 1e-6
    speed = np.hypot(*np.moveaxis(truth().velocity, -1, 0)[:2])
    assert reports[0].median_speed_cm_s == pytest.approx(np.median(speed), rel=0.1)
    assert reports[0].duration_s == pytest.approx(FRAMES / HZ, rel=0.01)


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


@pytest.mark.parametrize("name", CORPUS)
def test_an_honest_table_is_read(name, tmp_path):
    honest = CORPUS[name]
    source = honest.table()
    if isinstance(source, xarray.Dataset):
        check(honest, source)
        return
    check(honest, write(honest, tmp_path))
    if isinstance(source, pd.DataFrame) and not {"skip", "header"} & honest.layout.keys():
        plain = {n: v for n, v in honest.layout.items() if n not in ("separator", "decimal")}
        table = source.rename(columns=str.upper) if name.endswith("large names") else source
        check(
            Honest(honest.table, plain, has_headings=honest.has_headings, boats=honest.boats), table
        )


def test_the_corpus_is_as_large_as_it_is_said_to_be():
    assert len(CORPUS) >= 150


#: Of these the columns have names that nobody could know.
UNKNOWN = {"BioTracker", "UMATracker", "DLTdv", "VGG Image Annotator", "Fiji's manual tracking"}


@pytest.mark.parametrize("name", [name for name in PROGRAMS if name not in UNKNOWN])
def test_the_columns_of_a_program_are_guessed(name, tmp_path):
    """The guess has what no table says filled in, and then gives back the flock."""
    honest = PROGRAMS[name]
    path = write(honest, tmp_path)
    guess_layout(path)
    guessed = read_layout(path.with_suffix(".toml"))
    said = {n: v for n, v in honest.layout.items() if n in PLACE}
    fields = {n: getattr(guessed, n) for n in TrackLayout.__dataclass_fields__}
    for field_name in ("x", "y", "id", "heading", "quaternion", "box", "separator", "skip"):
        wanted = honest.layout.get(field_name)
        if wanted is not None and field_name not in ("id", "separator"):
            assert fields[field_name] in (wanted, _tuple(wanted)), field_name
    said = {"center": (0.0, 0.0), **said}
    said |= {"fps": HZ} if guessed.fps == 25.0 else {}  # To be checked, says the guess.
    turns = {n: v for n, v in honest.layout.items() if n.startswith("heading_")}
    check(Honest(honest.table, {**fields, **said, **turns}, **_rest(honest)), path)


def _rest(honest: Honest) -> dict[str, Any]:
    return {"has_headings": honest.has_headings, "boats": honest.boats}


def test_unknown_columns_are_listed(tmp_path):
    names = ["Ruta", "Farkost", "Bort [px]", "Upp [px]", "Vinkel [deg]"]
    text = rows()[["frame", "id", "x", "y", "angle"]].to_csv(
        index=False, sep=";", decimal=",", header=names
    )
    (tmp_path / "kamera.csv").write_text(text)
    checks = guess_layout(tmp_path / "kamera.csv")
    assert any(all(name in line for name in names) for line in checks)
    assert [line.split(" ")[0] for line in checks if "fill in" in line] == [
        "frame", "x", "y", "id", "pool",
    ]  # fmt: skip
    assert io.StringIO(text).readline().strip() == ";".join(names)


def test_columns_of_a_german_export_are_guessed(tmp_path):
    names = {"frame": "Zeit [s]", "id": "Boot", "x": "x", "y": "y", "heading": "Winkel [°]"}
    table = rows()[["frame", "id", "x", "y", "angle"]].assign(frame=lambda t: t["frame"] / HZ)
    table.to_csv(
        tmp_path / "kamera.csv", index=False, sep=";", decimal=",", header=[*names.values()]
    )
    checks = guess_layout(tmp_path / "kamera.csv")
    guessed = read_layout(tmp_path / "kamera.toml")
    assert {name: getattr(guessed, name) for name in names} == names
    assert not any("fill in" in line for line in checks)
