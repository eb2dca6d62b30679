"""The page: recordings, a template, a style sheet and scripts, in one file that loads nothing."""

import html
import json
import math
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.atomic_write import atomic_write
from flockenv.errors import ParameterError, short_repr
from flockenv.flock import ContactSeries
from flockenv.parameters import OBSTACLES
from flockenv.policies import policy
from flockenv.policies.names import LAWS
from flockenv.recording import PHASES, Recording
from flockenv.replay.packing import Packer
from flockenv.replay.quantities import decisive_minute, series_of, shown_quantities
from flockenv.replay.template import as_script_content, digest, filled, joined

MOST_BYTES = 10_000_000
"""Largest size of a page in bytes. A page of a longer run shows fewer samples per second."""

# In the order of their imports, since the page joins them into one script.
_SCRIPTS = (
    "packing.mjs",
    "shared/words.mjs",
    "shared/link.mjs",
    "shared/transport.mjs",
    "shared/run.mjs",
    "shared/forces.mjs",
    "shared/scene.mjs",
    "shared/chart.mjs",
    "shared/panel.mjs",
    "link.mjs",
    "player.mjs",
    "main.mjs",
)
# Largest size of a page without its runs, in bytes.
_SCRIPT_BYTES = 100_000
# The page shows every n-th sample, for the first of these n with which it is small enough.
_THINNING = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
_MOST_RUNS = 2
# More samples than this per run never fit.
_MOST_SAMPLES = 400_000
# Steps of rounding, finer than a page shows, in cm, rad, cm/s, rad/s and cm/s².
# Rudder commands have no unit.
_POSITION, _ANGLE, _SPEED, _TURNING, _FORCE = 0.01, 0.001, 0.05, 0.005, 0.1
_RUDDER = 0.002


@dataclass(frozen=True, slots=True)
class Replay:
    """A page that was written.

    Attributes
    ----------
    size : int
        Bytes.
    every : int
        1 if the page shows all samples, 2 if every other one, and so on.
    """

    size: int
    every: int


def write_replay(
    path: str | os.PathLike[str], recordings: Recording | Mapping[str, Recording]
) -> Replay:
    """Write one or two recordings as one HTML page that plays them and needs no network.

    The page opens at the minute of the largest change and plays at eight times real time. For
    one run this is the minute in which signed order changes most (mean of its second half minus
    mean of its first), and for two runs the minute in which their signed orders differ most on
    average. A link to the page may end in ``#t=240&speed=8``, a time in s and a speed.

    Parameters
    ----------
    path
        The file to write.
    recordings
        A recording, which is named after the file; or a dictionary of one or two recordings by
        their names on the page. Two play side by side. Forces are shown if a recording holds
        contacts (``simulate(..., contacts=True)``).

    Returns
    -------
    Replay
        The page's size, at most `MOST_BYTES`, and which samples it shows.

    Raises
    ------
    ParameterError
        If the path does not end in .html or .htm; if `recordings` is neither a recording nor a
        dictionary of one or two; if a recording has no samples or no poses, or is too large.
    OSError
        If the file cannot be written; an existing file is then unchanged.
    """
    if Path(path).suffix.lower() not in (".html", ".htm"):
        raise ParameterError(f"path = {os.fspath(path)!r} is not accepted: a name in .html or .htm")
    if isinstance(recordings, Recording):
        recordings = {Path(path).stem: recordings}
    argument: object = recordings
    if not isinstance(argument, Mapping):
        kind = type(argument).__name__
        raise ParameterError(f"a {kind} is not accepted: a recording, or recordings by their names")
    if not 1 <= len(recordings) <= _MOST_RUNS:
        raise ParameterError(f"{len(recordings)} recordings are not accepted: 1 or {_MOST_RUNS}")
    for name, recording in argument.items():
        if not isinstance(name, str) or not isinstance(recording, Recording):
            raise ParameterError(
                f"{short_repr(argument)} is not accepted: recordings by their names"
            )
        if len(recording) == 0 or not recording.has_poses:
            raise ParameterError(f"recording {name!r} is not accepted: samples with their poses")
    page, every = _fitting_page(recordings)
    with atomic_write(path) as file:
        file.write(page)
    return Replay(len(page), every)


def _fitting_page(recordings: Mapping[str, Recording]) -> tuple[bytes, int]:
    """Return a page of at most `MOST_BYTES`, and the n for which it shows every n-th sample."""
    longest = max(len(recording) for recording in recordings.values())
    # Thinning does not make samples smaller, so the size of a page bounds the next n from below.
    least_every = max(1.0, longest / _MOST_SAMPLES)
    for every in _THINNING:
        if every < least_every:
            continue
        page = _page(recordings, every).encode()
        if len(page) <= MOST_BYTES:
            return page, every
        least_every = every * (len(page) - _SCRIPT_BYTES) / MOST_BYTES
    raise ParameterError(
        f"the recordings do not fit a page of {MOST_BYTES} bytes, not even one in {_THINNING[-1]} "
        "samples: record fewer boats or a shorter run"
    )


def _page(recordings: Mapping[str, Recording], every: int) -> str:
    """Return the page that shows every `every`-th sample."""
    time_s, description = decisive_minute(list(recordings.values()))
    quantities = shown_quantities(list(recordings.values()))
    data = {
        "runs": [
            _run(name, recording, every, quantities) for name, recording in recordings.items()
        ],
        "quantities": quantities,
        "moment": {"time_s": time_s, "words": description},
    }
    style, script = _core.STYLE_SHEET + _read("shared/page.css"), joined(map(_read, _SCRIPTS))
    security = (
        "default-src 'none'",
        f"style-src {digest(style)}",
        f"script-src {digest(script)}",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    )
    parts = {
        "title": html.escape(" and ".join(recordings)),
        "policy": "; ".join(security),
        "style": style,
        "script": script,
        "data": as_script_content(json.dumps(data, separators=(",", ":"), allow_nan=False)),
    }
    return filled(_read("page.html"), parts)


@cache
def _read(name: str) -> str:
    return resources.files("flockenv.replay").joinpath(name).read_text("utf-8")


def _run(
    name: str, recording: Recording, every: int, quantities: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return a run's settings and packed series, as `Run` of run.mjs takes them."""
    parameters = recording.parameters
    outer_cm, inner_cm = _core.pool_radii_cm(parameters.pool)
    target = parameters.common_target
    description = {
        "name": name,
        "seed": str(recording.seed),
        "law": _law(recording),
        "version": recording.version,
        "parameters": {key: str(value) for key, value in parameters.to_dict().items()},
        "boats": parameters.n_boats,
        "leaders": parameters.n_leaders,
        "target": target,
        "bw_s": parameters.bw_s,
        "lengths": {
            # JSON has no infinity: open water has no outer wall.
            "outer_radius_cm": outer_cm if math.isfinite(outer_cm) else None,
            "inner_radius_cm": inner_cm,
            **parameters._in_core.hull_lengths,
        },
        **{kind: getattr(parameters, kind) for kind in OBSTACLES},
        # The phases of tracks may be unknown.
        "phases": PHASES.tolist() if _has_phases(recording) else [],
        "ids": None if recording.ids is None else recording.ids.tolist(),
        "samples": len(recording),
        "every": every,
        "data": _series(recording, every, quantities),
    }
    if parameters.n_leaders > 0 and target is None:  # Leaders have different targets.
        description["targets"] = list(parameters.target)
    return description


def _law(recording: Recording) -> str | None:
    """Return the name of the leaders' law, which gives the run its color; None if no law led."""
    pool = recording.parameters.pool
    for name in LAWS:
        with suppress(ParameterError):  # Some laws exist only in some pools.
            if policy(name, pool).name == recording.policy:
                return name
    return None


def _series(recording: Recording, every: int, quantities: list[dict[str, Any]]) -> str:
    """Return the packed series of a run, of every `every`-th sample."""
    shown = slice(None, None, every)
    packer = Packer()
    packer.add("time_s", recording.time_s[shown], 0.0005)
    phase = (recording.phase[shown, None] == PHASES).argmax(axis=1)
    packer.add_plain("phase", phase)
    packer.add_plain(
        "in_analysis_window", recording.in_analysis_window[shown] & _has_phases(recording)
    )
    pose, velocity = recording.pose[shown], recording.velocity[shown]
    if recording.ids is not None:
        packer.add_plain("present", np.isfinite(pose[..., 0]))
        pose, velocity = _without_gaps(pose), np.nan_to_num(velocity)
    packer.add("position_cm", pose[..., :2], _POSITION)
    packer.add("heading", pose[..., 2], _ANGLE)
    packer.add("speed_cm_s", np.hypot(velocity[..., 0], velocity[..., 1]), _SPEED)
    packer.add("turning_rate", velocity[..., 2], _TURNING)
    leaders = recording.parameters.n_leaders
    if leaders > 0:
        phi = _core.lap_orientation(pose[:, :leaders].astype(np.float64))
        packer.add("leader_phi", np.unwrap(phi, axis=0), _ANGLE)
    if recording.rudder is not None:
        packer.add_plain("rudder", recording.rudder[shown], _RUDDER)
    for quantity in quantities:
        values = series_of(recording, quantity["key"])[shown]
        if np.isfinite(values).all():
            # Rounded to a twentieth of the last digit that is shown.
            packer.add(quantity["key"], values, 10.0 ** -quantity["decimals"] / 20)
    if recording.contacts is not None:
        _add_contacts(packer, recording, recording.contacts, every)
    return packer.text()


def _has_phases(recording: Recording) -> bool:
    """Return whether the phase of every sample is known."""
    return bool((recording.phase != "").all())


def _without_gaps(pose: NDArray[Any]) -> NDArray[Any]:
    """Return poses in which a missing boat has its last known pose, or else its first one.

    A boat that is never present has zeros.
    """
    is_present = np.isfinite(pose[..., 0])
    present_sample = np.where(is_present, np.arange(len(pose))[:, None], -1)
    last_known = np.maximum.accumulate(present_sample, axis=0)
    first_known = is_present.argmax(axis=0)
    source_sample = np.where(last_known < 0, first_known, last_known)
    filled_pose: NDArray[Any] = np.take_along_axis(pose, source_sample[..., None], axis=0)
    filled_pose[np.isnan(filled_pose)] = 0.0
    return filled_pose


def _add_contacts(
    packer: Packer, recording: Recording, contacts: ContactSeries, every: int
) -> None:
    """Add the contacts of every `every`-th sample."""
    sample = np.repeat(np.arange(len(recording)), contacts.count)
    is_shown = sample % every == 0
    normal = contacts.normal[is_shown]
    # The normal and the coordinate along the core give the point on the hull.
    packer.add_plain("contact_count", contacts.count[::every])
    packer.add_plain("contact_i", contacts.i[is_shown])
    packer.add_plain("contact_j", contacts.j[is_shown])
    packer.add_plain("contact_along_cm", contacts.along_cm[is_shown], 0.1)
    packer.add_plain("contact_angle", np.arctan2(normal[:, 1], normal[:, 0]), 0.02)
    packer.add_plain("contact_force", np.minimum(contacts.force[is_shown], 1e6), _FORCE)
