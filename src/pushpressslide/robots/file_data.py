"""Content of a robot's file, whatever its format: links, joints, frames and shapes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from xml.etree.ElementTree import Element

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.facts import JointFacts, JointKind, LinkFacts, LinkShape
from pushpressslide.robots.file_values import (
    Triple,
    UnfitValue,
    moment,
    number,
    product,
)

KINDS: dict[str, JointKind] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
MOVING = tuple(kind for kind in KINDS if kind != "fixed")
INERTIA = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
LEAST_GYRATION = 5e-4
"""Smallest allowed radius of gyration [m] of a link. For comparison, that of the last
link of Franka's FR3 is 9e-4 m.
"""
TURNS = 2.0 * math.pi  # [rad] limit assumed for a continuous joint


@dataclass(frozen=True)
class Frame:
    """A named frame on a link."""

    name: str
    parent: str
    xyz: Triple
    rpy: Triple


@dataclass(frozen=True)
class Description:
    """Content of a robot's file."""

    name: str | None
    links: list[LinkFacts]
    joints: list[JointFacts]
    frames: list[Frame] = field(default_factory=list)
    shapes: list[LinkShape] = field(default_factory=list)
    # followed joint of each mimic joint, by name
    mimics: dict[str, str] = field(default_factory=dict)
    # type of joints that cannot be driven, by name: floating, ball, ...
    odd: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def mimicked(holder: Element) -> str:
    """Name of the joint that an element mimics. Empty without one."""
    mimic = holder.find("mimic")
    return "" if mimic is None else mimic.get("joint") or "another joint"


def kind_of(kind: str) -> JointKind:
    """Kind of a joint, from its type in the file. A type that cannot be driven counts
    as fixed.
    """
    return KINDS.get(kind, "fixed")


def inertia_of(
    link: str, values: Mapping[str, str | None], missing: float
) -> tuple[float, ...]:
    """Inertia (6,) [kg m^2] of a link. ``missing`` replaces moments that the file
    lacks.

    Raises UnfitValue for a moment or product of inertia that no body can have.
    """
    out = []
    for key in INERTIA:
        diagonal = key[1] == key[2]
        read = moment if diagonal else product
        text = values.get(key)
        default = missing if diagonal else 0.0
        out.append(default if text is None else read(text, f"link {link!r}, {key}"))
    return tuple(out)


def limits_of(
    name: str, kind: str, values: Mapping[str, str | None], negative: bool = False
) -> dict[str, float]:
    """Limits of a joint, with positions clipped to a few turns.

    A speed or an effort of 0 is a common placeholder and means no limit. With
    ``negative``, negative values also mean no limit.
    """

    def value(key: str, default: float) -> float:
        """A limit, or the substitute for a missing one."""
        text = values.get(key)
        if text is None:
            return default
        place = f"joint {name!r}, limit {key}"
        return number(text, place, "a number", lambda v: not math.isnan(v))

    lower = value("lower", -TURNS)
    upper = value("upper", TURNS)
    if kind != "continuous" and lower > upper:
        allowed = f"at most the upper one, {upper:g}"
        raise UnfitValue(f"joint {name!r}, limit lower", lower, allowed)
    if kind == "continuous" or lower == upper:
        lower = -TURNS
        upper = TURNS
    lower = max(lower, -4.0 * TURNS)
    upper = min(upper, 4.0 * TURNS)
    velocity = value("velocity", math.inf)
    effort = value("effort", math.inf)
    if velocity <= 0.0:
        velocity = math.inf
    if effort == 0.0 or (negative and effort < 0.0):
        effort = math.inf
    return {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}


def unit(axis: Triple, place: str) -> Triple:
    """Direction of an axis as a unit vector. Raises UnfitValue for a zero axis."""
    norm = math.hypot(*axis)
    if not 0.0 < norm < math.inf:
        raise UnfitValue(place, list(axis), "a direction, as 0 0 1")
    return (axis[0] / norm, axis[1] / norm, axis[2] / norm)


def rpy_of(R: Array) -> Triple:
    """Roll, pitch and yaw [rad] of a rotation (3, 3)."""
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) < 1e-12:
        return (math.atan2(-R[1, 2], R[1, 1]), pitch, 0.0)
    return (math.atan2(R[2, 1], R[2, 2]), pitch, math.atan2(R[1, 0], R[0, 0]))


def physical(link: LinkFacts) -> LinkFacts:
    """The link with a physically possible inertia, changed as little as necessary.

    Principal moments are positive, and none is larger than the sum of the other two.
    """
    if link.mass == 0.0:
        return link
    ixx, iyy, izz, ixy, ixz, iyz = link.inertia
    matrix = np.array(((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)))
    moments, axes = np.linalg.eigh(matrix)
    least = LEAST_GYRATION**2 * link.mass
    fitting = np.maximum(moments, least)
    fitting[2] = min(fitting[2], fitting[0] + fitting[1])
    if np.allclose(fitting, moments, rtol=1e-6, atol=0.0):
        return link
    own = axes @ np.diag(fitting) @ axes.T
    inertia = (own[0, 0], own[1, 1], own[2, 2], own[0, 1], own[0, 2], own[1, 2])
    return replace(link, inertia=tuple(map(float, inertia)))
