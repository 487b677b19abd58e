"""A body on a plane in each simulator, led by a wrench at the height of its base.

The centre of mass is at the centroid of the base, too, so that no force shifts the
load: what is left is the friction of the base.
"""

from __future__ import annotations

import math
from typing import Any, Literal

import mujoco
import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ExternallyAppliedSpatialForce,
)
from pydrake.multibody.tree import (
    SpatialInertia,
    UnitInertia,
    default_model_instance,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import TABLE
from pushpressslide.geometry.inertia import solid_moments
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.surface_friction import OBJECT_FRICTION, partner_friction
from pushpressslide.mujoco_sim.contact import Contacts, set_solver
from pushpressslide.mujoco_sim.feet import feet_of
from pushpressslide.mujoco_sim.shapes import FOOT, add_feet, add_solid
from pushpressslide.sim.contact import solve_contacts
from pushpressslide.sim.convert import planar_pose_from_positions, planar_twist
from pushpressslide.sim.plane import add_plane
from pushpressslide.sim.scenes import mesh_size
from pushpressslide.sim.surfaces import touched_shapes
from pushpressslide_studies.footprint_body import FRICTION, MASS

DRAKE_STEP = 4e-3
"""Step [s] of Drake, as in a run."""
MUJOCO_STEP = 1e-3
"""Step [s] of MuJoCo, as in a run with a body of this mass."""

Base = Literal["feet", "box", "box_pyramid"]


class DrakeRig:
    """The body in Drake, on a base of a run's scene or on its plain shape."""

    period = DRAKE_STEP

    def __init__(self, shape: Shape, plain: bool) -> None:
        """Build the scene."""
        builder = DiagramBuilder()
        plant, graph = AddMultibodyPlantSceneGraph(builder, self.period)
        solve_contacts(plant)
        half = 0.5 * shape.height
        x, y = shape.centroid
        self._center = np.array([x, y, -half])
        central = SpatialInertia(
            MASS, [0.0, 0.0, 0.0], UnitInertia(*solid_moments(shape))
        )
        body = plant.AddRigidBody(
            "object", default_model_instance(), central.Shift([-x, -y, half])
        )
        plane = add_plane(plant, TABLE, partner_friction(FRICTION))
        if plain:
            pieces = touched_shapes(shape, OBJECT_FRICTION, mesh_size(shape))
            for i, (piece, properties) in enumerate(pieces):
                plant.RegisterCollisionGeometry(
                    body, RigidTransform(), piece, f"object_{i}", properties
                )
        else:
            plane.stand(plant, body, shape, OBJECT_FRICTION)
        plant.Finalize()
        if not plain:
            plane.let_bases_stand(plant, graph)
        builder.ExportInput(plant.get_applied_spatial_force_input_port(), "wrench")
        diagram = builder.Build()
        self._plant = plant
        self._body = body
        self._simulator = Simulator(diagram)
        self._context = self._simulator.get_mutable_context()
        self._state = plant.GetMyMutableContextFromRoot(self._context)
        self._port = diagram.GetInputPort("wrench")
        self._start = RigidTransform([0.0, 0.0, half - 2e-6])
        self._q = body.floating_positions_start()
        self._v = plant.num_positions() + body.floating_velocities_start_in_v()
        self._ticks = 0

    def start(self) -> None:
        """Put the body at rest at the origin."""
        self._context.SetTime(0.0)
        self._plant.SetFreeBodyPose(self._state, self._body, self._start)
        zeros = np.zeros(self._plant.num_velocities())
        self._plant.SetVelocities(self._state, zeros)
        self._ticks = 0
        self.apply((0.0, 0.0, 0.0))
        self._simulator.Initialize()

    def apply(self, wrench: Vector3) -> None:
        """Apply a wrench (fx, fy, tau) about the centroid of the base, world axes."""
        fx, fy, tau = wrench
        force = ExternallyAppliedSpatialForce()
        force.body_index = self._body.index()
        force.p_BoBq_B = self._center
        force.F_Bq_W = SpatialForce(np.array([0.0, 0.0, tau]), np.array([fx, fy, 0.0]))
        self._port.FixValue(
            self._context, Value[list[ExternallyAppliedSpatialForce]]([force])
        )

    def step(self) -> None:
        """Simulate one period."""
        self._ticks += 1
        self._simulator.AdvanceTo(self._ticks * self.period)

    def motion(self) -> tuple[Pose2, Vector3]:
        """Pose, and velocity of the centroid of the base with the turn rate, in the
        world.
        """
        x = self._plant.GetPositionsAndVelocities(self._state).tolist()
        pose = planar_pose_from_positions(x[self._q : self._q + 7])
        vx, vy, w = planar_twist(x[self._v : self._v + 6])
        cx, cy = pose.rotate((float(self._center[0]), float(self._center[1])))
        return pose, (vx - w * cy, vy + w * cx, w)


class MujocoRig:
    """The body in MuJoCo, on feet or on its plain shape."""

    period = MUJOCO_STEP

    def __init__(self, shape: Shape, base: Base) -> None:
        """Build the model."""
        spec = mujoco.MjSpec()
        half = 0.5 * shape.height
        world = spec.worldbody
        plane = mujoco.mjtGeom.mjGEOM_PLANE
        floor = world.add_geom(name="floor", type=plane, size=[0.0, 0.0, 1.0])
        body = world.add_body(name="object", pos=[0.0, 0.0, half])
        body.add_freejoint()
        x, y = shape.centroid
        body.explicitinertial = True
        body.mass = MASS
        body.ipos = [x, y, -half]
        body.fullinertia = [MASS * v for v in solid_moments(shape)]
        if base == "feet":
            set_solver(spec, self.period, (0.0, 0.0, -GRAVITY))
            floor.contype = floor.conaffinity = 0
            _add_feet(spec, body, shape, self.period)
        else:
            spec.option.timestep = self.period
            if base == "box":
                spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
            floor.friction = [FRICTION, 0.0, 0.0]
            add_solid(spec, body, shape, "object")
            for geom in body.geoms:
                geom.contype = geom.conaffinity = 1
                geom.friction = [FRICTION, 0.0, 0.0]
        self._model = spec.compile()
        self._at = mujoco.MjData(self._model)
        self._body = self._model.body("object").id
        self._center = (x, y)

    def start(self) -> None:
        """Put the body at rest at the origin."""
        mujoco.mj_resetData(self._model, self._at)

    def apply(self, wrench: Vector3) -> None:
        """Apply a wrench (fx, fy, tau) about the centroid of the base, world axes."""
        fx, fy, tau = wrench
        self._at.xfrc_applied[self._body] = (fx, fy, 0.0, 0.0, 0.0, tau)

    def step(self) -> None:
        """Simulate one period."""
        mujoco.mj_step(self._model, self._at)

    def motion(self) -> tuple[Pose2, Vector3]:
        """Pose, and velocity of the centroid of the base with the turn rate, in the
        world.
        """
        px, py, _, w, _, _, z = self._at.qpos.tolist()
        pose = Pose2(px, py, 2.0 * math.atan2(z, w))
        vx, vy, _, _, _, rate = self._at.qvel.tolist()
        cx, cy = pose.rotate(self._center)
        return pose, (vx - rate * cy, vy + rate * cx, rate)


def _add_feet(spec: Any, body: Any, shape: Shape, period: float) -> None:
    contacts = Contacts(spec, period)
    feet = feet_of(shape)
    names = add_feet(body, "foot", feet.points, FOOT - 0.5 * shape.height)
    for foot, share in zip(names, feet.shares.tolist(), strict=True):
        contacts.stand("floor", foot, share, FRICTION)
