"""Programs of the field: each with a table that it writes, and the layout that reads it."""

import numpy as np
import pandas as pd

from .honest import ANGLE, CENTER, HZ, PIXEL_CM, PLACE, Honest, rows, truth
from .program_tables import (
    DLC,
    METERS,
    MIDDLE,
    MOT,
    SIDES,
    SLEAP_COLUMNS,
    boxes,
    deeplabcut,
    dotted,
    ethovision,
    mot,
    motive,
    movement,
    quaternions,
    ros,
    sleap,
    trackmate,
    trex,
    wide,
)

PROGRAMS: dict[str, Honest] = {
    "TRex": Honest(
        trex,
        {"pool": "narrow", "center": [c * PIXEL_CM for c in CENTER], "y_down": True}
        | {"frame": "time", "x": "X#wcentroid (cm)", "y": "Y#wcentroid (cm)", "heading": "ANGLE"},
        left_out={"without a position": 10},
    ),
    "TRex by frames, empty cells": Honest(
        lambda: trex(np.nan),
        {"pool": "narrow", "center": [c * PIXEL_CM for c in CENTER], "y_down": True, "fps": HZ}
        | {"x": "X#wcentroid (cm)", "y": "Y#wcentroid (cm)", "heading": "ANGLE"},
        left_out={"without a position": 10},
    ),
    "idtracker.ai": Honest(
        lambda: (
            wide(lambda n, b: f"{n}{b}")
            .assign(frame=lambda t: t["frame"] / HZ)
            .rename(columns={"frame": "seconds"})
        ),
        {**PLACE, "frame": "seconds", "x": "x{id}", "y": "y{id}", "heading": None},
        name="trajectories.csv",
        has_headings=False,
    ),
    "idtracker.ai with angles": Honest(
        lambda: wide(lambda n, b: f"{n}{b}", ("x", "y", "angle")),
        {**PLACE, **ANGLE, "fps": HZ, "x": "x{id}", "y": "y{id}", "heading": "angle{id}"},
    ),
    **{
        f"numbered columns like {x}": Honest(
            lambda x=x: (
                wide(lambda n, b: x.format(b).replace("x", n).replace("X", n.upper()), ("x", "y"))
                .assign(frame=lambda t: t["frame"] / HZ)
                .rename(columns={"frame": "seconds"})
                .join(wide(lambda n, b: f"{n}{b}", ("angle",)).drop(columns="frame"))
            ),
            {**PLACE, **ANGLE, "frame": "seconds", "heading": "angle{id}"}
            | {"x": x.format("{id}"), "y": x.replace("x", "y").replace("X", "Y").format("{id}")},
        )
        for x in ("x{}", "X_{}", "x{} [px]")
    },
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
    "DeepLabCut with a center, unsure once": Honest(
        lambda: deeplabcut(True, ("nose", "tail", "center"), unsure=True),
        {**PLACE, "fps": HZ, "least_confidence": 0.6, "x": "{id}.center_x", "y": "{id}.center_y"}
        | dotted(SIDES, "{id}.")
        | {"confidence": ("{id}.nose_likelihood", "{id}.tail_likelihood")},
        options={"index": True},
        left_out={"with too little confidence": 1},
    ),
    "DeepLabCut of one animal with a center": Honest(
        lambda: deeplabcut(False, ("nose", "tail", "center")),
        {**DLC, **SIDES, "x": "center_x", "y": "center_y", "id": None},
        boats=(1,),
        options={"index": True},
    ),
    "SLEAP with instances of no track": Honest(
        lambda: pd.concat([sleap(), sleap()[::50].assign(track="")]).sort_values("frame_idx"),
        {**PLACE, "fps": HZ, "frame": "frame_idx", "id": "track", **SLEAP_COLUMNS},
        left_out={"without a name": 19},
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
    **{
        f"EthoVision in {encoding}": Honest(
            ethovision,
            {**PLACE, "frame": "Trial time", "id": None, "x": "X center", "y": "Y center"}
            | {"heading": "Direction", "heading_unit": "deg", "separator": ";", "skip": 3},
            boats=(1,),
            options={"encoding": encoding},
            left_out={"without a position": 1},
        )
        for encoding in ("utf-8", "utf-16")
    },
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
