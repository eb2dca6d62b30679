"""`FlockMonitor`: stable-baselines3's monitor file with a row per episode of a flock."""

import json
import os
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from stable_baselines3.common.monitor import Monitor, ResultsWriter
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnvObs, VecEnvStepReturn

from flockenv._io.arguments import items
from flockenv.errors import ParameterError


class FlockMonitor(VecEnvWrapper):
    """Write the episodes of a `LeaderVecEnv` to a ``monitor.csv``, a row per flock's episode.

    `VecMonitor` would write a row per leader. stable-baselines3's ``results_plotter`` and
    ``load_results`` read the file. Its header names the registered environment that has the same
    options, or ``None``.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`, also inside other wrappers.
    filename
        The file; ``.monitor.csv`` is appended if it is missing.
    summary_keywords
        Further columns: entries of the ``"episode_summary"``, such as ``"signed_order"``. A cell is
        empty if the episode lacks the entry.
    override_existing
        Treatment of a file that has episodes already: True replaces it, False appends rows, as a
        resumed training needs, and None raises an error.

    Raises
    ------
    OSError
        If the file cannot be written.
    ParameterError
        If the file has episodes and `override_existing` is None, or if rows would be appended to a
        file with other columns.
    """

    def __init__(
        self,
        venv: VecEnv,
        filename: str,
        summary_keywords: Iterable[str] = (),
        override_existing: bool | None = None,
    ) -> None:
        super().__init__(venv)
        self._keywords = summary_keywords = tuple(items(summary_keywords, "summary_keywords"))
        path = _path(str(filename))
        columns = ["r", "l", "t", *summary_keywords]
        stored_start = None if override_existing is True else _start_of(path, columns)
        if stored_start is not None and override_existing is None:
            raise ParameterError(
                f"{path} has episodes already: override_existing=True replaces them, False adds "
                "to them"
            )
        self._start = time.time() if stored_start is None else stored_start
        spec = venv.get_attr("spec")[0]
        env_id = str(None if spec is None else spec.id)
        header: dict[str, float | str] = {"t_start": self._start, "env_id": env_id}
        # A file without episodes is replaced too: appending to a missing one writes no header.
        self._writer = ResultsWriter(
            str(path), header, summary_keywords, override_existing=stored_start is None
        )

    def reset(self) -> VecEnvObs:
        """Start episodes in all flocks."""
        return self.venv.reset()

    def step_wait(self) -> VecEnvStepReturn:
        """Take one decision, and write the episodes that end with it."""
        step = self.venv.step_wait()
        _, _, dones, infos = step
        for slot in np.flatnonzero(dones).tolist():
            info = infos[slot]
            if "episode" in info:
                summary = info["episode_summary"]
                extra = {name: summary.get(name, "") for name in self._keywords}
                elapsed = round(time.time() - self._start, 6)
                self._writer.write_row({**info["episode"], "t": elapsed, **extra})
        return step

    def close(self) -> None:
        """Close the file and the environment."""
        self._writer.close()
        self.venv.close()


def _path(filename: str) -> Path:
    """Return the path to which stable-baselines3's writer writes for a name."""
    if filename.endswith(Monitor.EXT):
        return Path(filename)
    return (
        Path(filename, Monitor.EXT)
        if os.path.isdir(filename)
        else Path(f"{filename}.{Monitor.EXT}")
    )


def _start_of(path: Path, columns: list[str]) -> float | None:
    """Return the start time in a monitor file; None if the file is missing or has no episodes.

    Refuses a file with other columns.
    """
    if not path.is_file():
        return None
    with path.open(encoding="utf-8", newline="") as file:
        header, column_line, first_row = (file.readline() for _ in range(3))
    if not first_row:
        return None
    try:
        stored_start = float(json.loads(header.removeprefix("#"))["t_start"])
    except (ValueError, KeyError, TypeError) as error:
        raise ParameterError(f"{path} is not a monitor file: give another name") from error
    present_columns = column_line.strip().split(",")
    if present_columns != columns:
        raise ParameterError(
            f"{path} has the columns {', '.join(present_columns)}, and not {', '.join(columns)}: "
            "give another name, or override_existing=True"
        )
    return stored_start
