"""Recordings as tables, which `read_tracks` reads again, and as GSD for OVITO and freud."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from flockenv import _core
from flockenv._io.arguments import as_bool
from flockenv._io.atomic_write import atomic_write, write_csv, write_text
from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr
from flockenv.recording import Recording

EXPORTS = (".csv", ".parquet", ".gsd")
"""Endings of files that `export` writes."""


def export(
    recording: Recording, path: str | os.PathLike[str], *, overwrite: bool = False
) -> list[Path]:
    """Write the poses of a recording for other programs, and return the files that were written.

    The ending of the path selects the format. A CSV or Parquet table (extra ``plot``) has one row
    per sample and boat, with the columns of `Recording.to_dataframe`. Beside it a layout in TOML is
    written, with which `read_tracks` reads the table. A GSD file (extra ``tracks``) has one frame
    per sample in the schema of HOOMD-blue: positions and the box in cm, orientations as quaternions
    about z, velocities in cm/s, and the types "boat" and "leader" with their hull. Its log has
    ``time_s`` and each boat's number.

    Parameters
    ----------
    recording, path
        What to write, and where; an existing table or GSD file is replaced.
    overwrite
        Whether to replace another layout beside the table, which may be written by hand.

    Raises
    ------
    ParameterError
        For another ending, a recording without poses, and another layout beside the table.
    MissingExtraError
        Without the extra.
    OSError
        If a file cannot be written; an existing file is then unchanged.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in EXPORTS:
        raise ParameterError(
            f"path = {os.fspath(path)!r} is not accepted: a name that ends in {', '.join(EXPORTS)}"
        )
    if not isinstance(recording, Recording):
        raise TypeError(f"recording must be a Recording, not {short_repr(recording)}")
    if len(recording) == 0 or not recording.has_poses:
        raise ParameterError("this recording holds no poses to export")
    if ending == ".gsd":
        _write_gsd(recording, path)
        return [path]
    layout_path = path.with_suffix(".toml")
    text = "# Columns and units of the table beside this file, for flockenv.\n"
    text += tomli_w.dumps(_layout(recording))
    is_other = layout_path.exists() and layout_path.read_bytes() != text.encode()
    if not as_bool(overwrite, "overwrite") and is_other:
        raise ParameterError(f"{layout_path} already exists, with another layout: overwrite=True")
    table = recording.to_dataframe(boats=True)
    if ending == ".csv":
        write_csv(path, table)
    else:
        require("pyarrow", "plot")
        with atomic_write(path) as file:
            table.to_parquet(file, index=False)
    write_text(layout_path, text)
    return [path, layout_path]


def _layout(recording: Recording) -> dict[str, Any]:
    """Return the fields of the layout of a recording's table."""
    parameters, ids = recording.parameters, recording.ids
    names = range(parameters.n_boats) if ids is None else ids
    columns: dict[str, Any] = {"frame": "time_s", "x": "x_cm", "y": "y_cm"}
    if (recording.time_s % 1.0 == 0.0).all():
        columns["fps"] = 1.0  # Without it, times in whole numbers are refused.
    return columns | {
        "id": "boat" if ids is None else "id",
        "heading": "heading_rad",
        "wrapped": False,
        "pool": parameters.pool,
        "hull": (parameters.boat_radius_cm, parameters.boat_shape),
        "target": parameters.target,
        "leaders": [str(name) for name in names[: parameters.n_leaders]],
    }


def _write_gsd(recording: Recording, path: Path) -> None:
    """Write a frame per sample, in a square box that holds all hulls."""
    hoomd = require("gsd.hoomd", "tracks")
    parameters = recording.parameters
    radius_cm, _ = _core.pool_radii_cm(parameters.pool)
    if math.isinf(radius_cm):  # Open water: the box reaches as far as the boats.
        radius_cm = float(np.nanmax(np.abs(recording.pose[..., :2])))
    side_cm = 2 * radius_cm + 4 * (1 + parameters.boat_shape) * parameters.boat_radius_cm
    # The library opens paths, not open files.
    with atomic_write(path) as file, hoomd.open(file.name, "w") as frames:
        for sample in range(len(recording)):
            frame = hoomd.Frame()
            frame.configuration.step = sample
            frame.configuration.dimensions = 2
            frame.configuration.box = [side_cm, side_cm, 0, 0, 0, 0]
            frame.log["time_s"] = recording.time_s[[sample]]
            _put_boats(frame, recording, sample)
            frames.append(frame)


def _put_boats(frame: Any, recording: Recording, sample: int) -> None:
    """Put the boats that are present into a frame, each as a line swept by a disc."""
    parameters, particles = recording.parameters, frame.particles
    radius, half = parameters.boat_radius_cm, parameters.boat_shape * parameters.boat_radius_cm
    ends = [[-half, 0.0], [half, 0.0]]
    capsule = {"type": "Polygon", "rounding_radius": radius, "vertices": ends}
    hull = capsule if half else {"type": "Sphere", "diameter": 2 * radius}
    pose = recording.pose[sample].astype(np.float64)
    boats = np.flatnonzero(np.isfinite(pose[:, 0]))
    pose, velocity = pose[boats], np.nan_to_num(recording.velocity[sample, boats])
    half_heading, zero = pose[:, 2] / 2, np.zeros(len(boats))
    particles.N = len(boats)
    particles.types = ["boat", "leader"]
    particles.type_shapes = [hull] * 2
    particles.typeid = boats < parameters.n_leaders
    particles.diameter = np.full(len(boats), 2 * radius)
    particles.position = np.column_stack([pose[:, :2], zero])
    particles.velocity = np.column_stack([velocity[:, :2], zero])
    # The hull lies along x and is rotated about z by the heading.
    cosine, sine = np.cos(half_heading), np.sin(half_heading)
    particles.orientation = np.column_stack([cosine, zero, zero, sine])
    frame.log["particles/boat"] = boats.astype(np.uint32)
