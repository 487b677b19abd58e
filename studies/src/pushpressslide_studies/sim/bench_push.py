"""A push of a box by a ball in Drake alone, as a contestant of the benchmarks."""

from __future__ import annotations

import math
from time import perf_counter
from typing import NamedTuple

from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    PdControllerGains,
    PrismaticJoint,
    SpatialInertia,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.sim.contact import solve_contacts

MODULUS = 1e7  # [Pa] of the box
FINE = 0.02  # [m] of the meshes
WIDE = 2.0  # [m] of the plane
DEPTH = 0.1  # [m]


class BoxPush(NamedTuple):
    """A box on a plane, and the ball that pushes it along x."""

    size: tuple[float, float, float]  # [m]
    mass: float  # [kg]
    friction: float  # of box and plane
    tip_friction: float  # of box and ball
    radius: float  # [m] of the ball
    off: float  # [m] of the ball beside the face's middle
    speed: float  # [m/s] of the ball


def pushed_box(
    push: BoxPush, time: float, step: float, stiffness: float
) -> tuple[float, float, float, float]:
    """Wall time [s] of ``time`` [s] of a push, and the box's final pose: x, y [m] and
    yaw [rad].

    ``step`` [s] is the time step of the physics, ``stiffness`` [N s/m] the gain of the
    ball's velocity servo.
    """
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    solve_contacts(plant, convex=True)  # TAMSI has no servo in a joint
    length, _, height = push.size
    inertia = SpatialInertia.SolidBoxWithMass(push.mass, *push.size)
    box = plant.AddRigidBody("box", inertia)
    soft = ProximityProperties()
    AddCompliantHydroelasticProperties(FINE, MODULUS, soft)
    # of the pair 2 a b / (a + b): with 1 for the box, the partner decides
    AddContactMaterial(friction=CoulombFriction(1.0, 1.0), properties=soft)
    plant.RegisterCollisionGeometry(box, RigidTransform(), Box(*push.size), "box", soft)
    plane = _rigid(push.friction)
    slab = Box(WIDE, WIDE, DEPTH)
    plant.RegisterCollisionGeometry(
        plant.world_body(),
        RigidTransform([0.0, 0.0, -0.5 * DEPTH]),
        slab,
        "plane",
        plane,
    )
    ball = plant.AddRigidBody(
        "ball", SpatialInertia.SolidSphereWithMass(0.5, push.radius)
    )
    place = RigidTransform([-0.5 * length - push.radius, push.off, 0.5 * height])
    joint = plant.AddJoint(
        PrismaticJoint(
            "ahead",
            plant.AddFrame(FixedOffsetFrame("start", plant.world_frame(), place)),
            ball.body_frame(),
            [1.0, 0.0, 0.0],
        )
    )
    actuator = plant.AddJointActuator("servo", joint)
    actuator.set_controller_gains(PdControllerGains(p=0.0, d=stiffness))
    plant.RegisterCollisionGeometry(
        ball, RigidTransform(), Sphere(push.radius), "ball", _rigid(push.tip_friction)
    )
    plant.SetDefaultFloatingBaseBodyPose(box, RigidTransform([0.0, 0.0, 0.5 * height]))
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    root = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(root)
    port = plant.get_desired_state_input_port(ball.model_instance())
    port.FixValue(context, [0.0, push.speed])
    simulator.Initialize()
    began = perf_counter()
    simulator.AdvanceTo(time)
    spent = perf_counter() - began
    X = plant.EvalBodyPoseInWorld(context, box)
    x, y, _ = X.translation().tolist()
    yaw = float(RollPitchYaw(X.rotation()).yaw_angle())
    return spent, x, y, math.remainder(yaw, 2.0 * math.pi)


def _rigid(pair: float) -> ProximityProperties:
    """Properties of the surface that touches the box, with the friction of the
    ``pair``.
    """
    out = ProximityProperties()
    AddRigidHydroelasticProperties(FINE, out)
    own = pair / (2.0 - pair)
    AddContactMaterial(friction=CoulombFriction(own, own), properties=out)
    return out
