"""`FlockMonitor`: stable-baselines3's monitor file with a row per episode of a flock."""

import time
from collections.abc import Iterable
from typing import Any

import numpy as np
from stable_baselines3.common.monitor import ResultsWriter
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

from flockenv._io.arguments import items


class FlockMonitor(VecEnvWrapper):
    """Write the episodes of a `LeaderVecEnv` to a ``monitor.csv``, a row per flock.

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
        Numbers of the ``"episode_summary"`` to write too, such as ``"signed_order"``; those that an
        episode does not have are left empty.

    Raises
    ------
    OSError
        If the file cannot be written.
    """

    def __init__(self, venv: VecEnv, filename: str, summary_keywords: Iterable[str] = ()) -> None:
        super().__init__(venv)
        self._start = time.time()
        self._keywords = summary_keywords = tuple(items(summary_keywords, "summary_keywords"))
        spec = venv.get_attr("spec")[0]
        header: dict[str, float | str] = {"t_start": self._start, "env_id": str(spec and spec.id)}
        self._writer = ResultsWriter(str(filename), header, extra_keys=summary_keywords)

    def reset(self) -> Any:
        """Start episodes in all flocks."""
        return self.venv.reset()

    def step_wait(self) -> Any:
        """Take the control step, and write the episodes that end with it."""
        step = self.venv.step_wait()
        for slot in np.flatnonzero(step[2]).tolist():
            info = step[3][slot]
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
