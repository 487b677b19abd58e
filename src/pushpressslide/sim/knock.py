"""The disturbances of a task in a plant of Drake."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.value import Value
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, RigidBody, SpatialInertia
from pydrake.systems.framework import Context, DiagramBuilder

from pushpressslide.control.disturbance import Pushes, ball_of
from pushpressslide.control.knocker import FRICTION, MASS, NAME, RADIUS, Knocker
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.surfaces import rigid_properties


class KnockerBody:
    """The ball as a body of a plant."""

    def __init__(self, plant: MultibodyPlant, plan: Plan) -> None:
        """Add the ball to a plant that is not finalized."""
        self.motion = Knocker(plan)
        self._body = _add_ball(plant)
        X = RigidTransform(self.motion.start)
        plant.SetDefaultFloatingBaseBodyPose(self._body, X)

    def touch_only(
        self, plant: MultibodyPlant, graph: SceneGraph, moving: RigidBody
    ) -> None:
        """Let the ball touch nothing but the object."""
        ball = GeometrySet(plant.GetCollisionGeometriesForBody(self._body))
        others = GeometrySet()
        for index in range(plant.num_bodies()):
            body = plant.get_body(BodyIndex(index))
            if body.index() not in (moving.index(), self._body.index()):
                for geometry in plant.GetCollisionGeometriesForBody(body):
                    others.Add(geometry)
        graph.collision_filter_manager().Apply(
            CollisionFilterDeclaration().ExcludeBetween(ball, others)
        )

    def connect(self, plant: MultibodyPlant) -> None:
        """Find the ball in the state of a finalized plant."""
        self._start = self._body.floating_positions_start()
        self._speed = (
            plant.num_positions() + self._body.floating_velocities_start_in_v()
        )

    def force(
        self, x: Sequence[float], pose: Pose2, t: float
    ) -> ExternallyAppliedSpatialForce:
        """Force on the ball for the next control period.

        ``x`` is the plant's state, ``pose`` the object's X_WG.
        """
        place = np.array(x[self._start + 4 : self._start + 7])
        velocity = np.array(x[self._speed + 3 : self._speed + 6])
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self._body.index()
        force = self.motion.force(place, velocity, pose, t)
        applied.F_Bq_W = SpatialForce(np.zeros(3), force)
        return applied


class Disturbances:
    """The ball and the pushes of a task, at an input port of a plant."""

    def __init__(self, plant: MultibodyPlant, plan: Plan, moving: RigidBody) -> None:
        """Add what is needed to a plant that is not finalized. ``moving`` is the
        object.
        """
        self.pushes = Pushes(plan.task)
        self.ball = None if ball_of(plan.task) is None else KnockerBody(plant, plan)
        self._frame = plan.task.support.frame
        self._moving = moving

    def connect(
        self, builder: DiagramBuilder, plant: MultibodyPlant, graph: SceneGraph
    ) -> None:
        """Export the input port of the forces on a finalized plant."""
        builder.ExportInput(plant.get_applied_spatial_force_input_port(), NAME)
        if self.ball is not None:
            self.ball.touch_only(plant, graph, self._moving)
            self.ball.connect(plant)

    def step(
        self, port: Any, context: Context, x: Sequence[float], pose: Pose2, t: float
    ) -> None:
        """Write the forces for the next control period.

        ``x`` is the plant's state, ``pose`` the object's X_WG.
        """
        applied = []
        if self.ball is not None:
            applied.append(self.ball.force(x, pose, t))
        if self.pushes:
            applied.append(self._push(pose, t))
        port.FixValue(context, Value[list[ExternallyAppliedSpatialForce]](applied))

    def _push(self, pose: Pose2, t: float) -> ExternallyAppliedSpatialForce:
        """Force of the pushes at the object's centre of mass."""
        fx, fy, moment = self.pushes.wrench(pose, t)
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self._moving.index()
        applied.p_BoBq_B = self._moving.default_com()
        about = moment * np.array(self._frame.spin_axis)
        force = self._frame.direction((fx, fy, 0.0))
        applied.F_Bq_W = SpatialForce(about, np.array(force))
        return applied


def _add_ball(plant: MultibodyPlant) -> RigidBody:
    instance = plant.AddModelInstance(NAME)
    inertia = SpatialInertia.SolidSphereWithMass(MASS, RADIUS)
    body = plant.AddRigidBody(NAME, instance, inertia)
    ball = Sphere(RADIUS)
    properties = rigid_properties(FRICTION, 0.3 * RADIUS)
    plant.RegisterCollisionGeometry(body, RigidTransform(), ball, NAME, properties)
    color = np.array([0.75, 0.15, 0.2, 1.0])
    plant.RegisterVisualGeometry(body, RigidTransform(), ball, f"{NAME}_visual", color)
    return body
