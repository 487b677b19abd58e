"""Robots in a MultibodyPlant, each with a tip for contact. The models are generated,
Drake's own, or from a file.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

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
    Joint,
    ModelInstanceIndex,
    RigidBody,
    SpatialInertia,
    UnitInertia,
    WeldJoint,
)

from pushpressslide.core import margins
from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import (
    PushPressSlideError,
    RobotFileError,
    TaskError,
    path_value,
)
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import EXACT, Truth, refuse_truth
from pushpressslide.robots.arm_files import mounts_tip, robot_facts, rod_length
from pushpressslide.robots.facts import TIP, TIP_MASS, RobotFacts
from pushpressslide.robots.true_arm import tip_center, true_facts, true_robot
from pushpressslide.robots.urdf import urdf_text
from pushpressslide.sim.link_shapes import add_shapes

DRAKE_MODELS_VARIABLE = "PUSHPRESSSLIDE_DRAKE_MODELS"
"""Environment variable with the folder of a copy of Drake's models. If it is not set,
Drake downloads them.
"""

DRAKE_MODELS = {
    "panda": "package://drake_models/franka_description/urdf/panda_arm.urdf",
    "iiwa7": "package://drake_models/iiwa_description/sdf/iiwa7_no_collision.sdf",
}
TIP_JOINT = f"{TIP}_joint"
STEEL = (0.55, 0.57, 0.60, 1.0)
RUBBER = (0.12, 0.12, 0.13, 1.0)
PEDESTAL = (0.35, 0.37, 0.40, 1.0)


@dataclass(frozen=True)
class RobotInstance:
    """One robot in a plant.

    Positions, velocities and actuators are ordered from the base to the tip.
    """

    name: str  # of the model instance
    facts: RobotFacts
    model_instance: ModelInstanceIndex
    base_frame: Frame
    tip_body: RigidBody  # a separate body, so that the force at its joint is measured
    tip_frame: Frame  # T: origin at the sphere's centre, z out of the flange
    tip_joint_name: str  # weld from the flange to the tip; its child frame is T
    # the sphere that touches, named "tip_sphere"; None without collision shapes
    tip_geometry: GeometryId | None

    @property
    def base_links(self) -> tuple[str, ...]:
        """Names of the base link and the first moving link, which are near the support
        in every posture.
        """
        return (self.facts.base, self.facts.moving[0].child)

    def joints(self, plant: MultibodyPlant) -> list[Joint]:
        """Moving joints, from the base to the tip."""
        return [
            plant.GetJointByName(fact.name, self.model_instance)
            for fact in self.facts.moving
        ]


@dataclass(frozen=True)
class _ModelField:
    """The task field that names a robot's model, for error messages."""

    source: str
    index: int
    model: str

    def error(self, advice: str) -> TaskError:
        """Error which says that the model cannot be used, with advice."""
        field = f"robots[{self.index}].model"
        return TaskError(self.source, field, path_value(self.model), advice)


def add_robot(
    plant: MultibodyPlant,
    robot: Robot,
    index: int,
    *,
    tip_properties: ProximityProperties | None = None,
    collision: bool = False,
    models: str = "generated",
    source: str = "task",
    truth: Truth = EXACT,
) -> RobotInstance:
    """Add the task's robot number ``index`` to a plant that is not finalized, with its
    base welded in place.

    ``tip_properties`` are the contact properties of the tip's sphere; with None it
    touches nothing. ``collision`` also registers capsules around the links of generated
    models, without hydroelastic properties, for distance queries in a plant that is not
    simulated. ``models`` is "generated" or "drake_models". ``source`` is the task file,
    for messages. The arm differs from the robot by ``truth``.

    Raises TaskError if the model, its file or its tip frame cannot be used.
    """
    field = _ModelField(source, index, robot.model)
    robot = true_robot(robot, truth)
    facts = true_facts(_facts(robot, field), truth)
    instance = _add_model(plant, field, facts, models, collision, truth)
    base = _weld_base(plant, robot, facts, instance)
    length = rod_length(robot)
    inertia = SpatialInertia.Zero()  # a file with a tip frame contains its tip
    if mounts_tip(robot):
        mass = truth.link_mass * TIP_MASS
        inertia = _tip_inertia(mass, length, robot.tip_radius)
    center = tip_center(length, truth)
    tip = _add_tip(plant, instance, facts, center, inertia)
    geometry = None
    if plant.geometry_source_is_registered():
        if collision and tip_properties is None:
            tip_properties = ProximityProperties()
        if length > 0.0:
            _add_rod(
                plant, tip, length, margins.rod_radius(robot.tip_radius), collision
            )
        geometry = _add_sphere(plant, tip, robot.tip_radius, tip_properties)
        _add_pedestal(plant, robot, facts, index)
    name = plant.GetModelInstanceName(instance)
    return RobotInstance(
        name, facts, instance, base, tip, tip.body_frame(), TIP_JOINT, geometry
    )


def _weld_base(
    plant: MultibodyPlant, robot: Robot, facts: RobotFacts, instance: ModelInstanceIndex
) -> Frame:
    """Weld the base to its pose in the world, and return its frame."""
    base = plant.GetFrameByName(facts.base, instance)
    X_WBase = RigidTransform(RollPitchYaw(0.0, 0.0, robot.base_yaw), robot.base)
    plant.WeldFrames(plant.world_frame(), base, X_WBase)
    return base


def _facts(robot: Robot, field: _ModelField) -> RobotFacts:
    """Facts about a robot, from its generated model or from its file."""
    try:
        return robot_facts(robot)
    except RobotFileError:
        raise  # names the file itself
    except PushPressSlideError as error:
        raise field.error(str(error)) from error


def _add_model(
    plant: MultibodyPlant,
    field: _ModelField,
    facts: RobotFacts,
    models: str,
    collision: bool,
    truth: Truth,
) -> ModelInstanceIndex:
    """Add the links and joints of a model, from its source."""
    if models not in ("generated", "drake_models"):
        advice = "choose generated or drake_models"
        raise TaskError(field.source, "models", models, advice)
    parser = Parser(plant, model_name_prefix=f"robot_{field.index}")
    parser.SetAutoRenaming(True)
    if models == "drake_models" and field.model in DRAKE_MODELS:
        own = replace(truth, link_mass=1.0, viscous_friction=0.0)
        refuse_truth(truth, own, field.source, "with models drake_models")
        return _add_drake_model(parser, field)
    try:
        (instance,) = parser.AddModelsFromString(urdf_text(facts, collision), "urdf")
    except RuntimeError as error:
        reason = " ".join(str(error).split())[:200]
        raise _file_error(field, f"Drake cannot load it: {reason}") from error
    if plant.geometry_source_is_registered():
        add_shapes(plant, instance, facts.shapes, collision)
    return instance


def _add_drake_model(parser: Parser, field: _ModelField) -> ModelInstanceIndex:
    """Add one of Drake's own models, from a local copy if there is one."""
    folder = os.environ.get(DRAKE_MODELS_VARIABLE)
    packages = parser.package_map()
    if folder:
        if not (Path(folder) / "package.xml").is_file():
            advice = "name a folder with Drake's models (it has a package.xml)"
            raise TaskError(field.source, "drake_models", folder, advice)
        if packages.Contains("drake_models"):
            packages.Remove("drake_models")
        packages.Add("drake_models", folder)
    try:
        (instance,) = parser.AddModelsFromUrl(DRAKE_MODELS[field.model])
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0][:160]
        advice = f"Drake's model could not be loaded ({reason}); use generated or set {DRAKE_MODELS_VARIABLE}"
        raise TaskError(field.source, "models", "drake_models", advice) from error
    return instance


def _file_error(field: _ModelField, reason: str) -> RobotFileError:
    """Error which says that a model's file cannot be used."""
    return RobotFileError(field.model, "", field.model, reason)


def _flange(
    plant: MultibodyPlant, instance: ModelInstanceIndex, facts: RobotFacts
) -> tuple[Frame, RigidTransform]:
    """Frame of the flange, and the flange's pose in that frame.

    In a model that has no frame for the flange, the frame is that of the flange's
    parent link.
    """
    if plant.HasFrameNamed(facts.flange, instance):
        return plant.GetFrameByName(facts.flange, instance), RigidTransform()
    joint = next(j for j in facts.joints if j.child == facts.flange)
    parent = plant.GetFrameByName(joint.parent, instance)
    return parent, RigidTransform(RollPitchYaw(*joint.rpy), joint.xyz)


def _add_tip(
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    facts: RobotFacts,
    center: Vector3,
    inertia: SpatialInertia,
) -> RigidBody:
    """Weld the tip's body to the flange, with its ``center`` [m] in the flange's frame."""
    flange, X_FlangeF = _flange(plant, instance, facts)
    X_FT = X_FlangeF @ RigidTransform(center)
    tip = plant.AddRigidBody(TIP, instance, inertia)
    plant.AddJoint(WeldJoint(TIP_JOINT, flange, tip.body_frame(), X_FT))
    return tip


def _tip_inertia(mass: float, length: float, radius: float) -> SpatialInertia:
    """Inertia of sphere and rod about the sphere's centre, in the axes of the tip.

    The rod has two thirds of the ``mass`` [kg], the sphere one third.
    """
    rod = mass * 2.0 / 3.0
    ball = mass / 3.0
    thick = margins.rod_radius(radius)
    cylinder = UnitInertia.SolidCylinder(thick, length, [0.0, 0.0, 1.0])
    unit = cylinder.ShiftFromCenterOfMass([0.0, 0.0, 0.5 * length])
    inertia = SpatialInertia(rod, [0.0, 0.0, -0.5 * length], unit)
    inertia += SpatialInertia.SolidSphereWithMass(ball, radius)
    return inertia


def _add_rod(
    plant: MultibodyPlant,
    tip: RigidBody,
    length: float,
    radius: float,
    collision: bool,
) -> None:
    """Draw the rod with a ``radius`` [m], and its collar. With ``collision`` the rod is
    also a capsule for clearances.
    """
    X_TRod = RigidTransform([0.0, 0.0, -0.5 * length])
    rod = Cylinder(radius, length)
    plant.RegisterVisualGeometry(tip, X_TRod, rod, "tip_rod_visual", STEEL)
    X_TCollar = RigidTransform([0.0, 0.0, 0.006 - length])
    collar = Cylinder(3.0 * margins.ROD_RADIUS, 0.012)
    plant.RegisterVisualGeometry(tip, X_TCollar, collar, "tip_collar_visual", STEEL)
    if collision:
        capsule = Capsule(radius, length)
        properties = ProximityProperties()
        plant.RegisterCollisionGeometry(tip, X_TRod, capsule, "tip_rod", properties)


def _add_sphere(
    plant: MultibodyPlant,
    tip: RigidBody,
    radius: float,
    properties: ProximityProperties | None,
) -> GeometryId | None:
    """Draw the tip's sphere. It makes contact if it has contact ``properties``."""
    X = RigidTransform()
    sphere = Sphere(radius)
    plant.RegisterVisualGeometry(tip, X, sphere, "tip_visual", RUBBER)
    if properties is None:
        return None
    return plant.RegisterCollisionGeometry(tip, X, sphere, "tip_sphere", properties)


def _add_pedestal(
    plant: MultibodyPlant, robot: Robot, facts: RobotFacts, index: int
) -> None:
    """Draw a column under a base that stands above the floor."""
    x, y, z = robot.base
    if z <= 0.0 or facts.base_radius <= 0.0:
        return
    column = Cylinder(facts.base_radius, z)
    foot = Cylinder(1.5 * facts.base_radius, min(0.02, z))
    for shape, part in ((column, "column"), (foot, "foot")):
        X = RigidTransform([x, y, 0.5 * shape.length()])
        name = f"pedestal_{index}_{part}"
        plant.RegisterVisualGeometry(plant.world_body(), X, shape, name, PEDESTAL)
