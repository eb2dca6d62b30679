"""The scene in Drake: capsules on planar joints, boxes behind the outer wall's chords, a cylinder
for the obstacle, point contacts without friction. They are so stiff that the solver SAP falls
back to its near-rigid limit."""

from __future__ import annotations

import numpy as np
from flock_drive import FlockDrive, outer_corners
from pydrake.geometry import (
    AddContactMaterial,
    Box,
    Capsule,
    Cylinder,
    ProximityProperties,
    Shape,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
)
from pydrake.multibody.tree import PlanarJoint, RigidBody, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

NAME = "Drake"
SETTINGS = {"SAP": None}
# Thickness of the wall's boxes and height of everything, in cm.
WALL_CM, HEIGHT_CM = 10.0, 4.0
# Length of a box over that of its chord: its ends lie behind others. Boats catch on shorter boxes.
CHORDS_LONG = 3.0
# For boats of 1 kg and centimeters as meters, above the stiffness that SAP treats as rigid.
STIFFNESS = 1e12


class Engine:
    """A run of a task."""

    def __init__(self, task: dict, start: dict, setting: str) -> None:
        del setting
        self.drive = FlockDrive(task, start["time_s"])
        self.dt_s = task["dt_s"]
        self.moment = task["gyration_cm"] ** 2
        builder = DiagramBuilder()
        self.plant, _ = AddMultibodyPlantSceneGraph(builder, self.dt_s)
        self.plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        self.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
        self._add_walls(task)
        for boat in range(len(start["poses"])):
            self._add_boat(task, boat)
        self.plant.Finalize()
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.plant.SetPositions(self.context, np.ravel(start["poses"]))
        self.plant.SetVelocities(self.context, np.ravel(start["velocities"]))
        self.forces = self.plant.get_applied_generalized_force_input_port()
        self.forces.FixValue(self.context, np.zeros(self.plant.num_velocities()))
        self.simulator.Initialize()
        self.steps = 0

    def _add_walls(self, task: dict) -> None:
        world = self.plant.world_body()
        if task["inner_cm"] > 0:
            shape = Cylinder(task["inner_cm"], HEIGHT_CM)
            self._add_shape(world, RigidTransform(), shape, "inner")
        if task["outer_cm"] is None:
            return
        corners = outer_corners(task["outer_cm"])
        for number, (a, b) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
            middle, along = (a + b) / 2, b - a
            middle = middle * (1 + WALL_CM / 2 / np.linalg.norm(middle))
            shape = Box(CHORDS_LONG * np.linalg.norm(along), WALL_CM, HEIGHT_CM)
            turn = RollPitchYaw(0.0, 0.0, np.arctan2(along[1], along[0]))
            pose = RigidTransform(turn, [*middle, 0.0])
            self._add_shape(world, pose, shape, f"outer {number}")

    def _add_shape(self, body: RigidBody, pose: RigidTransform, shape: Shape, name: str) -> None:
        material = ProximityProperties()
        smooth = CoulombFriction(0.0, 0.0)
        AddContactMaterial(point_stiffness=STIFFNESS, friction=smooth, properties=material)
        # Dissipation as fast as the solver allows, so that contacts do not bounce.
        material.AddProperty("material", "relaxation_time", 0.0)
        self.plant.RegisterCollisionGeometry(body, pose, shape, name, material)

    def _add_boat(self, task: dict, boat: int) -> None:
        radius, half_length = task["hull_cm"]
        inertia = SpatialInertia(
            1.0, np.zeros(3), UnitInertia(self.moment, self.moment, self.moment)
        )
        body = self.plant.AddRigidBody(f"boat {boat}", inertia)
        lying = RigidTransform(RollPitchYaw(0.0, np.pi / 2, 0.0), np.zeros(3))
        shape = Capsule(radius, 2 * half_length)
        self._add_shape(body, lying, shape, f"hull {boat}")
        frame = self.plant.world_frame()
        self.plant.AddJoint(PlanarJoint(f"joint {boat}", frame, body.body_frame()))

    def state(self) -> np.ndarray:
        """Return x, y, heading, vx, vy and omega of each boat, shape (n, 6)."""
        pose = self.plant.GetPositions(self.context).reshape(-1, 3)
        velocity = self.plant.GetVelocities(self.context).reshape(-1, 3)
        return np.hstack((pose, velocity))

    def push(self) -> None:
        """Apply the forces of the next step."""
        state = self.state()
        force, spin_up, increments = self.drive.push(state)
        pushed = np.column_stack((force, self.moment * spin_up))
        self.forces.FixValue(self.context, np.ravel(pushed))
        if increments.any():
            state[:, 5] += increments
            self.plant.SetVelocities(self.context, np.ravel(state[:, 3:]))

    def step(self) -> None:
        """Take one step; only this call is timed."""
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * self.dt_s)

    def wall_force(self) -> float:
        """Return the force on the outer wall along x in the last step, in cm/s^2."""
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        world = self.plant.world_body().index()
        total = 0.0
        for number in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(number)
            if world in (contact.bodyA_index(), contact.bodyB_index()):
                total += abs(contact.contact_force()[0])
        return total
