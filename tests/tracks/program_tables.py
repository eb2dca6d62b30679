"""The flock's table as programs of the field write it."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray

from .honest import BOATS, CENTER, HZ, PIXEL_CM, PLACE, Rows, rows


def wide(column: Callable[[str, Any], str], names: tuple[str, ...] = ("x", "y")) -> Rows:
    """One row per frame: the columns of each boat beside each other."""
    parts = {
        column(name, boat): own.set_index("frame")[name]
        for boat, own in rows().groupby("id")
        for name in names
    }
    return pd.DataFrame(parts).reset_index()


def deeplabcut(
    several: bool, parts: tuple[str, ...] = ("nose", "tail"), *, unsure: bool = False
) -> Rows:
    """Key points in levels of header; if `unsure`, the fourth boat is seen badly in a frame."""
    columns = {}
    for boat, own in rows().set_index("frame").groupby("id"):
        if not several and boat != 1:
            continue
        for part in parts:
            for coord in ("x", "y", "likelihood"):
                values = own.get(f"{part}_{coord}", own.get(coord, own["x"] * 0 + 0.98)).copy()
                if unsure and boat == 4 and coord == "likelihood":
                    values[30] = 0.1
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


def ethovision() -> str:
    """One animal, once lost: lines before the header, and units under it."""
    table = rows()[rows()["id"] == 1].assign(t=lambda t: t["frame"] / HZ).astype(object)
    table.iloc[5, table.columns.get_indexer(["x", "y", "angle"])] = "-"
    lines = table[["t", "x", "y", "angle"]].to_csv(sep=";", index=False, header=False)
    before = '"Number of header lines:";"5"\n"Start time";"05/04/2026 10:00:00"\n\n'
    header = '"Trial time";"X center";"Y center";"Direction"\n"s";"px";"px";"deg"\n'
    return before + header + lines


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
