"""Robots in a MultibodyPlant: generated, Drake's own, or from a URDF or SDF, each with
a tip for contact.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydrake.geometry import (
    Capsule,
    Cylinder,
    GeometryId,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Frame,
    ModelInstanceIndex,
    RigidBody,
    SpatialInertia,
    UnitInertia,
    WeldJoint,
)

from pushpressslide.core.errors import PushPressSlideError, TaskError
from pushpressslide.core.task import Robot
from pushpressslide.robots.description import read_description
from pushpressslide.robots.facts import MODELS, TIP_MASS, RobotFacts, load_facts
from pushpressslide.robots.urdf import urdf_text

ModelSource = Literal["generated", "drake_models"]

DRAKE_MODELS_VARIABLE = "PUSHPRESSSLIDE_DRAKE_MODELS"
"""Environment variable with a folder that holds a copy of Drake's models; without it
Drake downloads them.
"""

DRAKE_MODELS = {
    "panda": "package://drake_models/franka_description/urdf/panda_arm.urdf",
    "iiwa7": "package://drake_models/iiwa_description/sdf/iiwa7_no_collision.sdf",
}
ROD_RADIUS = 0.008  # [m] of the steel rod between flange and sphere
TIP_JOINT = "tip_joint"
STEEL = (0.55, 0.57, 0.60, 1.0)
RUBBER = (0.12, 0.12, 0.13, 1.0)
PEDESTAL = (0.35, 0.37, 0.40, 1.0)


@dataclass(frozen=True)
class RobotInstance:
    """One robot as it stands in a plant; positions, velocities and actuators run from
    the base to the tip.
    """

    name: str  # of the model instance
    facts: RobotFacts
    model_instance: ModelInstanceIndex
    base_frame: Frame
    tip_body: RigidBody  # its own body, so that the force at its joint can be measured
    tip_frame: Frame  # T: origin at the sphere's centre, z out of the flange
    tip_joint_name: str  # weld from the flange to the tip; its child frame is T
    tip_geometry: (
        GeometryId | None
    )  # the sphere that touches, named "tip_sphere"; None if it was not asked for

    @property
    def base_links(self) -> tuple[str, ...]:
        """Names of the base link and of the one that turns on it: near the support
        wherever the arm is.
        """
        return (self.facts.base, self.facts.moving[0].child)


def add_robot(
    plant: MultibodyPlant,
    robot: Robot,
    index: int,
    *,
    tip_properties: ProximityProperties | None = None,
    collision: bool = False,
    models: str = "generated",
    drake_models: Path | None = None,
    source: str = "task",
) -> RobotInstance:
    """Add a task's robot number ``index`` to a plant not yet finalized, its base welded
    where the task says.

    tip_properties: the tip's sphere touches with these; None: it does not touch.
    collision: also registers capsules around the links (generated models), without
    hydroelastic properties, for distance queries in a plant that is not simulated.
    models: "generated" or "drake_models"; drake_models: folder of a local copy of the
    latter. source: the task file, for messages. Raises TaskError if the model, its file
    or its tip frame cannot be used.
    """
    field = f"robots[{index}]"
    own = robot.model in MODELS
    try:
        facts = (
            load_facts(robot.model)
            if own
            else read_description(robot.model, robot.tip_frame)
        )
    except PushPressSlideError as error:
        raise TaskError(source, f"{field}.model", robot.model, str(error)) from error
    if models not in ("generated", "drake_models"):
        raise TaskError(source, "models", models, "choose generated or drake_models")
    parser = Parser(plant, model_name_prefix=f"robot_{index}")
    parser.SetAutoRenaming(True)
    if own and models == "drake_models" and robot.model in DRAKE_MODELS:
        instance = _add_drake_model(parser, robot.model, drake_models, source)
    elif own:
        (instance,) = parser.AddModelsFromString(urdf_text(facts, collision), "urdf")
    else:
        instance = _add_file(plant, parser, Path(robot.model), facts, source, field)
    base = plant.GetFrameByName(facts.base, instance)
    X_WBase = RigidTransform(RollPitchYaw(0.0, 0.0, robot.base_yaw), robot.base)
    plant.WeldFrames(plant.world_frame(), base, X_WBase)
    length = robot.tip_length if own else 0.0
    flange, X_FlangeF = _flange(plant, instance, facts)
    X_FT = X_FlangeF @ RigidTransform([0.0, 0.0, length])
    tip = plant.AddRigidBody(
        "tip",
        instance,
        _tip_inertia(length, robot.tip_radius) if own else SpatialInertia.Zero(),
    )
    plant.AddJoint(WeldJoint(TIP_JOINT, flange, tip.body_frame(), X_FT))
    geometry = None
    if plant.geometry_source_is_registered():
        geometry = _add_tip_shapes(
            plant, tip, length, robot.tip_radius, tip_properties, collision
        )
        _add_pedestal(plant, robot, facts, index)
    name = plant.GetModelInstanceName(instance)
    return RobotInstance(
        name, facts, instance, base, tip, tip.body_frame(), TIP_JOINT, geometry
    )


def _add_drake_model(
    parser: Parser, model: str, folder: Path | None, source: str
) -> ModelInstanceIndex:
    local = folder or (
        Path(os.environ[DRAKE_MODELS_VARIABLE])
        if os.environ.get(DRAKE_MODELS_VARIABLE)
        else None
    )
    packages = parser.package_map()
    if local is not None:
        if not (local / "package.xml").is_file():
            raise TaskError(
                source,
                "drake_models",
                str(local),
                "name a folder with Drake's models (it has a package.xml)",
            )
        if packages.Contains("drake_models"):
            packages.Remove("drake_models")
        packages.Add("drake_models", str(local))
    try:
        (instance,) = parser.AddModelsFromUrl(DRAKE_MODELS[model])
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0][:160]
        advice = f"Drake's model could not be loaded ({reason}); use generated or set {DRAKE_MODELS_VARIABLE}"
        raise TaskError(source, "models", "drake_models", advice) from error
    return instance


def _add_file(
    plant: MultibodyPlant,
    parser: Parser,
    path: Path,
    facts: RobotFacts,
    source: str,
    field: str,
) -> ModelInstanceIndex:
    for folder in path.resolve().parents:
        if (folder / "package.xml").is_file():
            if not parser.package_map().Contains(folder.name):
                parser.package_map().Add(folder.name, str(folder))
            break
    try:
        instances = parser.AddModels(str(path))
    except RuntimeError as error:
        reason = " ".join(str(error).split())[:200]
        raise TaskError(
            source, f"{field}.model", str(path), f"Drake cannot load it: {reason}"
        ) from error
    if len(instances) != 1:
        raise TaskError(
            source,
            f"{field}.model",
            str(path),
            f"give a file with one model, not {len(instances)}",
        )
    instance = instances[0]
    wanted = {joint.name for joint in facts.moving}
    for joint_index in plant.GetJointIndices(instance):
        joint = plant.get_joint(joint_index)
        if joint.num_velocities() and joint.name() not in wanted:
            advice = f"its joint {joint.name()!r} does not lead to the tip frame; make it fixed"
            raise TaskError(source, f"{field}.model", str(path), advice)
        if joint.parent_body() == plant.world_body():
            advice = (
                f"its joint {joint.name()!r} holds it in the world; leave its base free"
            )
            raise TaskError(source, f"{field}.model", str(path), advice)
    actuators = [plant.get_joint_actuator(a) for a in plant.GetJointActuatorIndices()]
    driven = {a.joint().name() for a in actuators if a.model_instance() == instance}
    for fact in facts.moving:
        if fact.name not in driven:
            plant.AddJointActuator(
                fact.name, plant.GetJointByName(fact.name, instance), fact.effort
            )
    return instance


def _flange(
    plant: MultibodyPlant, instance: ModelInstanceIndex, facts: RobotFacts
) -> tuple[Frame, RigidTransform]:
    """Return the flange's frame; where the model has none, its link's frame and the
    flange's pose in it.
    """
    if plant.HasFrameNamed(facts.flange, instance):
        return plant.GetFrameByName(facts.flange, instance), RigidTransform()
    joint = next(j for j in facts.joints if j.child == facts.flange)
    return plant.GetFrameByName(joint.parent, instance), RigidTransform(
        RollPitchYaw(*joint.rpy), joint.xyz
    )


def _tip_inertia(length: float, radius: float) -> SpatialInertia:
    """Return the inertia about the sphere's centre, tip axes: two thirds of the mass
    are in the rod.
    """
    rod = TIP_MASS * 2.0 / 3.0
    ball = TIP_MASS / 3.0
    rod_inertia = SpatialInertia(
        rod,
        [0.0, 0.0, -0.5 * length],
        UnitInertia.SolidCylinder(
            ROD_RADIUS, length, [0.0, 0.0, 1.0]
        ).ShiftFromCenterOfMass([0.0, 0.0, 0.5 * length]),
    )
    rod_inertia += SpatialInertia.SolidSphereWithMass(ball, radius)
    return rod_inertia


def _add_tip_shapes(
    plant: MultibodyPlant,
    tip: RigidBody,
    length: float,
    radius: float,
    properties: ProximityProperties | None,
    collision: bool,
) -> GeometryId | None:
    if length > 0.0:
        X_TRod = RigidTransform([0.0, 0.0, -0.5 * length])
        plant.RegisterVisualGeometry(
            tip, X_TRod, Cylinder(ROD_RADIUS, length), "tip_rod_visual", STEEL
        )
        collar = RigidTransform([0.0, 0.0, 0.006 - length])
        plant.RegisterVisualGeometry(
            tip, collar, Cylinder(3.0 * ROD_RADIUS, 0.012), "tip_collar_visual", STEEL
        )
        if collision:
            plant.RegisterCollisionGeometry(
                tip,
                X_TRod,
                Capsule(ROD_RADIUS, length),
                "tip_rod",
                ProximityProperties(),
            )
    plant.RegisterVisualGeometry(
        tip, RigidTransform(), Sphere(radius), "tip_visual", RUBBER
    )
    if properties is None and not collision:
        return None
    chosen = properties or ProximityProperties()
    return plant.RegisterCollisionGeometry(
        tip, RigidTransform(), Sphere(radius), "tip_sphere", chosen
    )


def _add_pedestal(
    plant: MultibodyPlant, robot: Robot, facts: RobotFacts, index: int
) -> None:
    x, y, z = robot.base
    if z <= 0.0 or facts.base_radius <= 0.0:
        return
    column = Cylinder(facts.base_radius, z)
    foot = Cylinder(1.5 * facts.base_radius, min(0.02, z))
    for shape, name in ((column, "column"), (foot, "foot")):
        X = RigidTransform([x, y, 0.5 * shape.length()])
        plant.RegisterVisualGeometry(
            plant.world_body(), X, shape, f"pedestal_{index}_{name}", PEDESTAL
        )
