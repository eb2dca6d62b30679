"""Recordings out: long tables that `read_tracks` reads again, and GSD for OVITO and freud."""

import math
import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import tomli_w

from flockenv import _core
from flockenv._io.atomic_write import atomic_write, write_csv, write_text
from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.recording import Recording

EXPORTS = (".csv", ".parquet", ".gsd")
"""Endings of files that `export` writes."""


def export(recording: Recording, path: str | os.PathLike[str]) -> list[Path]:
    """Write the poses of a recording for other programs.

    A CSV or Parquet table (extra ``plot``) has one row per sample and boat, with the columns of
    `Recording.to_dataframe`, and beside it a layout in TOML, with which `read_tracks` reads it. A
    GSD file (extra ``tracks``) has one frame per sample in the schema of HOOMD-blue: positions and
    the box in cm, orientations as quaternions about z, velocities in cm/s, the types "boat" and
    "leader" with their hull, and ``time_s`` and the number of each boat in the log.

    Parameters
    ----------
    recording
        With poses.
    path
        The file; its ending decides.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ParameterError
        For another ending, and a recording without poses.
    MissingExtraError
        Without the extra.
    OSError
        If a file cannot be written; what was there before is still there.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in EXPORTS:
        raise ParameterError(
            f"path = {os.fspath(path)!r} is not accepted: a name that ends in {', '.join(EXPORTS)}"
        )
    if len(recording) == 0 or not recording.has_poses:
        raise ParameterError("this recording holds no poses to export")
    if ending == ".gsd":
        _write_gsd(recording, path)
        return [path]
    table = recording.to_dataframe(boats=True)
    if ending == ".csv":
        write_csv(path, table)
    else:
        require("pyarrow", "plot")
        with atomic_write(path) as file:
            table.to_parquet(file, index=False)
    beside = path.with_suffix(".toml")
    write_text(beside, _layout_text(recording))
    return [path, beside]


def _layout_text(recording: Recording) -> str:
    """Return the layout of the exported table, as TOML."""
    parameters = recording.parameters
    names = range(parameters.n_boats) if recording.ids is None else recording.ids.tolist()
    layout = {
        "frame": "time_s",
        "id": "boat" if recording.ids is None else "id",
        "x": "x_cm",
        "y": "y_cm",
        "heading": "heading_rad",
        "pool": parameters.pool,
        "hull": [parameters.boat_radius_cm, parameters.boat_shape],
        "target": parameters.target,
        "leaders": [str(each) for each in names][: parameters.n_leaders],
        "wrapped": False,
    }
    note = "# Columns and units of the table beside this file, for flockenv.\n"
    return note + tomli_w.dumps(layout)


def _write_gsd(recording: Recording, path: Path) -> None:
    hoomd: Any = require("gsd.hoomd", "tracks")
    # The library opens names, not files: it is made elsewhere first.
    with TemporaryDirectory() as folder:
        written = Path(folder, "made.gsd")
        with hoomd.open(str(written), "w") as file:
            file.extend(_gsd_frame(hoomd, recording, sample) for sample in range(len(recording)))
        with atomic_write(path) as file:
            file.write(written.read_bytes())


def _gsd_frame(hoomd: Any, recording: Recording, sample: int) -> Any:
    parameters = recording.parameters
    pose = recording.pose[sample].astype(np.float64)
    there = np.isfinite(pose[:, 0])
    boats, pose = np.flatnonzero(there), pose[there]
    velocity = np.nan_to_num(recording.velocity[sample].astype(np.float64)[there])
    flat, half = np.zeros((len(pose), 1)), pose[:, 2] / 2
    frame = hoomd.Frame()
    frame.configuration.step = sample
    frame.configuration.dimensions = 2
    frame.configuration.box = [_box_cm(recording)] * 2 + [0, 0, 0, 0]
    particles = frame.particles
    particles.N = len(pose)
    particles.types = ["boat", "leader"]
    particles.typeid = (boats < parameters.n_leaders).astype(np.uint32)
    particles.position = np.hstack([pose[:, :2], flat])
    # A turn about z by the heading, from a hull along x.
    particles.orientation = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1)
    particles.velocity = np.hstack([velocity[:, :2], flat])
    particles.diameter = np.full(len(pose), 2 * parameters.boat_radius_cm)
    particles.type_shapes = [_shape(recording)] * 2
    frame.log = {
        "time_s": np.array([recording.time_s[sample]]),
        "particles/boat": boats.astype(np.uint32),
    }
    return frame


def _shape(recording: Recording) -> dict[str, Any]:
    """Return the hull as GSD's schema has it: a line swept by a disc."""
    radius = recording.parameters.boat_radius_cm
    half = recording.parameters.boat_shape * radius
    if half == 0.0:
        return {"type": "Sphere", "diameter": 2 * radius}
    return {"type": "Polygon", "rounding_radius": radius, "vertices": [[-half, 0.0], [half, 0.0]]}


def _box_cm(recording: Recording) -> float:
    """Return the side of a square about the pool, or about where boats are in open water."""
    outer, _ = _core.pool_radii_cm(recording.parameters.pool)
    margin = 4 * (1 + recording.parameters.boat_shape) * recording.parameters.boat_radius_cm
    if math.isfinite(outer):
        return 2 * outer + margin
    return 2 * float(np.nanmax(np.abs(recording.pose[..., :2]))) + margin
