"""Eqs (8) and (9) as forces, and walls as chords, for engines that have neither."""

from __future__ import annotations

import math

import numpy as np

CHORDS = 512


class FlockDrive:
    """Clock, phases and noise of one run; states are (n, 6): x y heading vx vy omega."""

    def __init__(self, task: dict, time_s: float) -> None:
        self.dt_s = task["dt_s"]
        self.c0, self.c1, self.c3, self.c4 = task["constants"]
        forward, backward = task["speeds_cm_s"]
        self._thrusts = (forward, 0.0, -backward, 0.0)
        self._phase_ends = np.cumsum([round(1e9 * phase) for phase in task["phases_s"]])
        self._time = round(1e9 * time_s)
        self._dt = round(1e9 * self.dt_s)
        self._noise = np.random.default_rng(task["seed"])

    def push(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return forces (n, 2), angular accelerations (n,) and noise increments (n,) of a step."""
        elapsed = self._time % int(self._phase_ends[-1])
        phase = int(np.searchsorted(self._phase_ends, elapsed, side="right"))
        self._time += self._dt
        heading, velocity, omega = state[:, 2], state[:, 3:5], state[:, 5]
        axis = np.column_stack((np.cos(heading), np.sin(heading)))
        force = self.c0 * (self._thrusts[phase] * axis - velocity)
        along = (axis * velocity).sum(axis=1)
        spin_up = -self.c1 * omega**3 - self.c3 * omega * along
        increments = np.zeros(len(state))
        if self.c4 > 0:
            increments = self.c4 * math.sqrt(self.dt_s) * self._noise.standard_normal(len(state))
        return force, spin_up, increments


def outer_corners(radius: float) -> np.ndarray:
    """Return the corners (CHORDS, 2) of the outer wall; a chord's middle is on the x axis."""
    angles = (2 * np.arange(CHORDS) + 1) * math.pi / CHORDS
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))
