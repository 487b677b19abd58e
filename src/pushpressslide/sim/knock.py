"""The ball of ``control.knocker`` in a plant of Drake."""

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

from pushpressslide.control.knocker import FRICTION, MASS, NAME, RADIUS, Knocker
from pushpressslide.core.knock import Knock
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.surfaces import rigid_properties


class KnockerBody:
    """The ball as a body of a plant."""

    def __init__(self, plant: MultibodyPlant, knock: Knock, plan: Plan) -> None:
        """Add the ball to a plant that is not finalized."""
        self.motion = Knocker(knock, plan)
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

    def connect(self, builder: DiagramBuilder, plant: MultibodyPlant) -> None:
        """Export the input port of the force."""
        builder.ExportInput(plant.get_applied_spatial_force_input_port(), NAME)
        self._start = self._body.floating_positions_start()
        self._speed = (
            plant.num_positions() + self._body.floating_velocities_start_in_v()
        )

    def step(
        self, port: Any, context: Context, x: Sequence[float], pose: Pose2, t: float
    ) -> None:
        """Write the force for the next control period.

        ``x`` is the plant's state, ``pose`` the object's X_WG.
        """
        place = np.array(x[self._start + 4 : self._start + 7])
        velocity = np.array(x[self._speed + 3 : self._speed + 6])
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self._body.index()
        force = self.motion.force(place, velocity, pose, t)
        applied.F_Bq_W = SpatialForce(np.zeros(3), force)
        port.FixValue(context, Value[list[ExternallyAppliedSpatialForce]]([applied]))


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
