"""The scene in MuJoCo: capsules with two slides and a hinge, capsules for the outer wall's chords,
a sphere for the obstacle, contacts without friction, all other settings at their defaults."""

from __future__ import annotations

import mujoco
import numpy as np
from flock_drive import FlockDrive, outer_corners

NAME = "MuJoCo"
SETTINGS = {"Newton": None}
# Thickness of the wall's chords in cm.
WALL_CM = 2.0


class Engine:
    """A run of a task."""

    def __init__(self, task: dict, start: dict, setting: str) -> None:
        del setting
        self.model = mujoco.MjModel.from_xml_string(_xml(task, len(start["poses"])))
        self.data = mujoco.MjData(self.model)
        self.drive = FlockDrive(task, start["time_s"])
        self.dt_s = task["dt_s"]
        self.moment = task["gyration_cm"] ** 2
        self.data.qpos[:] = np.ravel(start["poses"])
        self.data.qvel[:] = np.ravel(start["velocities"])

    def state(self) -> np.ndarray:
        """Return x, y, heading, vx, vy and omega of each boat, shape (n, 6)."""
        return np.hstack((self.data.qpos.reshape(-1, 3), self.data.qvel.reshape(-1, 3)))

    def push(self) -> None:
        """Apply the forces of the next step."""
        force, spin_up, increments = self.drive.push(self.state())
        applied = self.data.qfrc_applied.reshape(-1, 3)
        applied[:, :2] = force
        applied[:, 2] = self.moment * spin_up
        self.data.qvel[2::3] += increments

    def step(self) -> None:
        """Take one step; only this call is timed."""
        mujoco.mj_step(self.model, self.data)

    def wall_force(self) -> float:
        """Return the force on the outer wall in the last step, in cm/s^2."""
        total, force = 0.0, np.zeros(6)
        for k, contact in enumerate(self.data.contact):
            if 0 in self.model.geom_bodyid[contact.geom]:
                mujoco.mj_contactForce(self.model, self.data, k, force)
                total += force[0]
        return total


def _xml(task: dict, boats: int) -> str:
    radius, half_length = task["hull_cm"]
    moment = task["gyration_cm"] ** 2
    walls = []
    if task["inner_cm"] > 0:
        walls.append(f'<geom type="sphere" size="{task["inner_cm"]}"/>')
    if task["outer_cm"] is not None:
        corners = outer_corners(task["outer_cm"])
        # Chords lie behind their inner faces.
        corners *= 1 + WALL_CM / np.linalg.norm(corners[0] + corners[1]) * 2
        for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            ends = f"{x0:.17g} {y0:.17g} 0 {x1:.17g} {y1:.17g} 0"
            walls.append(f'<geom type="capsule" size="{WALL_CM}" fromto="{ends}"/>')
    boat = f"""
      <body>
        <joint type="slide" axis="1 0 0"/>
        <joint type="slide" axis="0 1 0"/>
        <joint type="hinge" axis="0 0 1"/>
        <inertial pos="0 0 0" mass="1" diaginertia="{moment} {moment} {moment}"/>
        <geom type="capsule" size="{radius}" fromto="{-half_length} 0 0 {half_length} 0 0"/>
      </body>"""
    return f"""
    <mujoco>
      <option timestep="{task["dt_s"]}" gravity="0 0 0"/>
      <default><geom condim="1"/></default>
      <worldbody>{"".join(walls)}{boat * boats}</worldbody>
    </mujoco>"""
