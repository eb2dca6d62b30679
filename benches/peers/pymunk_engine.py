"""The scene in pymunk (Chipmunk): segments for the outer wall, a disc for the obstacle."""

from __future__ import annotations

import numpy as np
import pymunk
from flock_drive import FlockDrive, outer_corners
from pymunk import batch

NAME = "pymunk"
# Solver iterations; the default is 10.
SETTINGS = {"10 iterations": 10, "30 iterations": 30}

STATE = (
    batch.BodyFields.POSITION
    | batch.BodyFields.ANGLE
    | batch.BodyFields.VELOCITY
    | batch.BodyFields.ANGULAR_VELOCITY
)
PUSH = batch.BodyFields.ANGULAR_VELOCITY | batch.BodyFields.FORCE | batch.BodyFields.TORQUE


class Engine:
    """A run of a task."""

    def __init__(self, task: dict, start: dict, setting: str) -> None:
        self.space = pymunk.Space()
        self.space.iterations = SETTINGS[setting]
        self.drive = FlockDrive(task, start["time_s"])
        self.dt_s = task["dt_s"]
        self.moment = task["gyration_cm"] ** 2
        self._add_walls(task)
        states = zip(start["poses"], start["velocities"], strict=True)
        self.boats = [self._add_boat(task, pose, velocity) for pose, velocity in states]
        self._read, self._write = batch.Buffer(), batch.Buffer()

    def _add_walls(self, task: dict) -> None:
        static = self.space.static_body
        shapes = []
        if task["inner_cm"] > 0:
            shapes.append(pymunk.Circle(static, task["inner_cm"]))
        if task["outer_cm"] is not None:
            corners = [tuple(map(float, corner)) for corner in outer_corners(task["outer_cm"])]
            count = len(corners)
            for k in range(count):
                ends = corners[k], corners[(k + 1) % count]
                segment = pymunk.Segment(static, *ends, 0.0)
                # A segment that knows its neighbors does not let boats catch on its corners.
                segment.set_neighbors(corners[k - 1], corners[(k + 2) % count])
                shapes.append(segment)
        for shape in shapes:
            shape.friction = shape.elasticity = 0.0
        self.space.add(*shapes)

    def _add_boat(self, task: dict, pose: list, velocity: list) -> pymunk.Body:
        radius, half_length = task["hull_cm"]
        body = pymunk.Body(mass=1.0, moment=self.moment)
        body.position, body.angle = tuple(pose[:2]), pose[2]
        body.velocity, body.angular_velocity = tuple(velocity[:2]), velocity[2]
        shape = pymunk.Segment(body, (-half_length, 0.0), (half_length, 0.0), radius)
        shape.friction = shape.elasticity = 0.0
        self.space.add(body, shape)
        return body

    def state(self) -> np.ndarray:
        """Return x, y, heading, vx, vy and omega of each boat, shape (n, 6)."""
        self._read.clear()
        batch.get_space_bodies(self.space, STATE, self._read)
        # The walls' body comes after the boats.
        return np.frombuffer(self._read.float_buf()).reshape(-1, 6)[: len(self.boats)]

    def push(self) -> None:
        """Apply the forces of the next step."""
        state = self.state()
        force, spin_up, increments = self.drive.push(state)
        # The buffer takes the layout of what was read into it last.
        self._write.clear()
        batch.get_space_bodies(self.space, PUSH, self._write)
        rows = np.frombuffer(self._write.float_buf()).reshape(-1, 4)[: len(self.boats)]
        rows[:, 0] = state[:, 5] + increments
        rows[:, 1:3] = force
        rows[:, 3] = self.moment * spin_up
        batch.set_space_bodies(self.space, PUSH, self._write)

    def step(self) -> None:
        """Take one step; only this call is timed."""
        self.space.step(self.dt_s)

    def wall_force(self) -> float:
        """Return the force on the outer wall along x in the last step, in cm/s^2."""
        impulses = []

        def add_wall_impulse(arbiter: pymunk.Arbiter) -> None:
            if any(shape.body is self.space.static_body for shape in arbiter.shapes):
                impulses.append(abs(arbiter.total_impulse.x))

        for boat in self.boats:
            boat.each_arbiter(add_wall_impulse)
        return sum(impulses) / self.dt_s
