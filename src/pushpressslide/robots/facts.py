"""Published facts about the robots: kinematics, inertias and limits, as frozen arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources
from typing import Any, Literal

import numpy as np
import yaml

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.scene import MODELS

JointKind = Literal["revolute", "prismatic", "fixed"]
ShapeKind = Literal["box", "cylinder", "capsule", "sphere", "mesh"]

# name of our tip's body: no link of a given robot may have it
TIP = "pushpressslide_tip"
TIP_MASS = 0.15
"""Mass [kg] of rod and sphere."""
# the loader in C, ten times as quick, where PyYAML was built with it
FASTEST = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def exact_angle(angle: float) -> float:
    """``angle`` [rad], snapped to a multiple of pi/2 within 1e-5."""
    quarter = round(angle / (0.5 * math.pi)) * 0.5 * math.pi
    return quarter if abs(angle - quarter) < 1e-5 else angle


def rotation_from_rpy(rpy: tuple[float, float, float]) -> Array:
    """Rotation R (3, 3) = Rz(yaw) Ry(pitch) Rx(roll), the URDF convention.

    Entries of quarter turns are exact.
    """

    def cos_sin(angle: float) -> tuple[float, float]:
        """Cosine and sine, exact at quarter turns."""
        c = math.cos(angle)
        s = math.sin(angle)
        return (round(c) if abs(c - round(c)) < 1e-15 else c), (
            round(s) if abs(s - round(s)) < 1e-15 else s
        )

    (cr, sr), (cp, sp), (cy, sy) = (cos_sin(a) for a in rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ],
        dtype=np.float64,
    )


@dataclass(frozen=True)
class LinkFacts:
    """A rigid link. A link without mass only carries a frame."""

    name: str
    mass: float = 0.0  # [kg]
    # [m] centre of mass in the link's frame
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)
    # [rad] of the inertia's axes in the link's frame
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    # [kg m^2] ixx, iyy, izz, ixy, ixz, iyz about the centre of mass
    inertia: tuple[float, ...] = (0.0,) * 6


@dataclass(frozen=True)
class JointFacts:
    """A joint: the pose of its frame in the parent link's frame, its axis in its own
    frame, and its limits.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    xyz: tuple[float, float, float]  # [m]
    rpy: tuple[float, float, float]  # [rad]
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    lower: float = 0.0  # [rad] or [m]
    upper: float = 0.0
    velocity: float = math.inf  # [rad/s] or [m/s]
    acceleration: float = math.inf  # [rad/s^2] or [m/s^2]
    effort: float = math.inf  # [N m] or [N]
    torque_rate: float = math.inf  # [N m/s]; infinite if the maker states none
    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0  # [kg m^2] at the motor ([kg] of a slide)
    damping: float = 0.0  # [N m s/rad] or [N s/m]

    @property
    def armature(self) -> float:
        """Rotor inertia reflected to the joint, [kg m^2], or [kg] for a slide: that of
        the motor times gear ratio^2.
        """
        return self.rotor_inertia * self.gear_ratio**2


@dataclass(frozen=True)
class Capsule:
    """All points within ``radius`` [m] of the segment from p to q [m], in the frame of
    ``link``.
    """

    link: str
    p: tuple[float, float, float]
    q: tuple[float, float, float]
    radius: float


@dataclass(frozen=True)
class LinkShape:
    """A shape of a link in a robot's file, for clearances or for pictures."""

    link: str
    kind: ShapeKind
    # [m] box: sides; cylinder, capsule: radius, length along z; sphere: radius;
    # mesh: scale of each axis
    size: tuple[float, ...]
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m] in the link's frame
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    solid: bool = True  # for clearances; False: only drawn
    mesh: str = ""  # path of its file
    color: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class RobotFacts:
    """A serial robot with n moving joints, from its base link to its flange."""

    name: str
    links: tuple[LinkFacts, ...]
    joints: tuple[JointFacts, ...]  # from base to flange, fixed ones included
    base: str  # link that is bolted down
    flange: str  # link whose z axis points out of the flange
    home_posture: tuple[float, ...]  # (n,) [rad] or [m]; the tool points down
    base_radius: float = 0.0  # [m] of a pedestal that carries the base
    capsules: tuple[Capsule, ...] = ()  # around the links, for clearances
    visuals: tuple[Mapping[str, Any], ...] = ()  # drawn shapes, see models/*.yaml
    colors: Mapping[str, tuple[float, float, float]] | None = None
    branches: tuple[JointFacts, ...] = ()  # fixed joints to links off the chain
    shapes: tuple[LinkShape, ...] = ()  # of a file
    notes: tuple[str, ...] = ()  # notes on what was fixed, ignored or assumed in a file
    home_first: bool = False  # whether a search begins in the ready posture

    @cached_property
    def moving(self) -> tuple[JointFacts, ...]:
        """The n moving joints, starting at the base."""
        return tuple(j for j in self.joints if j.kind != "fixed")

    @property
    def size(self) -> int:
        """Number n of moving joints."""
        return len(self.moving)

    @cached_property
    def home(self) -> Array:
        """Ready posture (n,) [rad] or [m]."""
        return np.array(self.home_posture, dtype=np.float64)

    @cached_property
    def lower(self) -> Array:
        """Lower position limits (n,) [rad] or [m]."""
        return np.array([j.lower for j in self.moving])

    @cached_property
    def upper(self) -> Array:
        """Upper position limits (n,) [rad] or [m]."""
        return np.array([j.upper for j in self.moving])

    @cached_property
    def velocity_limit(self) -> Array:
        """Speed limits (n,) [rad/s] or [m/s]."""
        return np.array([j.velocity for j in self.moving])

    @cached_property
    def effort_limit(self) -> Array:
        """Torque limits (n,) [N m], or force limits [N] for slides."""
        return np.array([j.effort for j in self.moving])

    @cached_property
    def torque_rate_limit(self) -> Array:
        """Limits of the torque's rate (n,) [N m/s].

        Infinite for joints without a published limit.
        """
        return np.array([j.torque_rate for j in self.moving])

    @cached_property
    def armature(self) -> Array:
        """Rotor inertias (n,) reflected to the joints, [kg m^2], or [kg] for slides:
        the inertia on the motor side times the square of the gear ratio.
        """
        return np.array([j.armature for j in self.moving])


def _triple(values: Any) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def _angles(values: Any) -> tuple[float, float, float]:
    roll, pitch, yaw = (exact_angle(float(v)) for v in values)
    return (roll, pitch, yaw)


def _link(data: Mapping[str, Any]) -> LinkFacts:
    if "mass" not in data:
        return LinkFacts(data["name"])
    inertia = tuple(
        float(data["inertia"][key])
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    com = _triple(data["com"])
    rpy = _angles(data.get("rpy", (0, 0, 0)))
    return LinkFacts(data["name"], float(data["mass"]), com, rpy, inertia)


def _joint(data: Mapping[str, Any]) -> JointFacts:
    fields = dict(data)
    fields["kind"] = fields.pop("type")
    fields["xyz"], fields["rpy"] = _triple(fields["xyz"]), _angles(fields["rpy"])
    fields["axis"] = _triple(fields.get("axis", (0, 0, 1)))
    return JointFacts(**fields)


def _capsule_visual(capsule: Mapping[str, Any]) -> Mapping[str, Any]:
    """Visual of a link that is described only by capsules."""
    return {**capsule, "shape": "capsule", "color": "grey"}


@cache
def load_facts(name: str) -> RobotFacts:
    """Facts about a robot in the package, one of ``MODELS``.

    Raises PushPressSlideError for any other name.
    """
    if name not in MODELS:
        raise PushPressSlideError(
            f"no facts of a robot {name!r}; there are {', '.join(MODELS)}"
        )
    text = (
        resources.files("pushpressslide.robots")
        .joinpath("models", f"{name}.yaml")
        .read_text("utf-8")
    )
    data = yaml.load(text, Loader=FASTEST)
    return RobotFacts(
        name=data["name"],
        links=tuple(_link(item) for item in data["links"]),
        joints=tuple(_joint(item) for item in data["joints"]),
        base=data["base"],
        flange=data["flange"],
        home_posture=tuple(float(v) for v in data["home"]),
        base_radius=float(data["base_radius"]),
        capsules=tuple(
            Capsule(c["link"], _triple(c["p"]), _triple(c["q"]), float(c["radius"]))
            for c in data["capsules"]
        ),
        visuals=tuple(data.get("visuals", map(_capsule_visual, data["capsules"]))),
        colors={key: _triple(value) for key, value in data.get("colors", {}).items()},
        home_first=data.get("home_first", False),
    )
