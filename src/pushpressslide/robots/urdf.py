"""URDF text generated from a robot's facts: kinematics, inertias, limits, rotors,
smooth shapes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from pushpressslide.robots.facts import JointFacts, LinkFacts, RobotFacts

SOLID_GREY = (0.7, 0.7, 0.7)


def numbers(values: Iterable[float]) -> str:
    """The values in URDF notation, without rounding."""
    return " ".join(repr(float(v)) for v in values)


def pose_between(
    p: Sequence[float], q: Sequence[float]
) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    """Midpoint (3,) [m] of p and q, roll-pitch-yaw angles (3,) [rad] that point z from
    p towards q, and the distance [m] of p and q.
    """
    d = [float(b) - float(a) for a, b in zip(p, q, strict=True)]
    length = math.sqrt(sum(v * v for v in d))
    middle = tuple(0.5 * (float(a) + float(b)) for a, b in zip(p, q, strict=True))
    if length == 0.0:
        return middle, (0.0, 0.0, 0.0), 0.0
    return (
        middle,
        (0.0, math.atan2(math.hypot(d[0], d[1]), d[2]), math.atan2(d[1], d[0])),
        length,
    )


def _between(shape: str, p: Sequence[float], q: Sequence[float], radius: float) -> str:
    middle, rpy, length = pose_between(p, q)
    origin = f'<origin xyz="{numbers(middle)}" rpy="{numbers(rpy)}"/>'
    return f'{origin}<geometry><{shape} radius="{radius!r}" length="{length!r}"/></geometry>'


def _visual(facts: RobotFacts, index: int) -> str:
    item = facts.visuals[index]
    rgb = (facts.colors or {}).get(item["color"], SOLID_GREY)
    if item["shape"] == "ellipsoid":
        a, b, c = (float(v) for v in item["axes"])
        shape = f'<drake:ellipsoid a="{a!r}" b="{b!r}" c="{c!r}"/>'
        body = f'<origin xyz="{numbers(item["p"])}"/><geometry>{shape}</geometry>'
    else:
        body = _between(item["shape"], item["p"], item["q"], float(item["radius"]))
    material = f'<material name="{item["color"]}"><color rgba="{numbers((*rgb, 1.0))}"/></material>'
    return f'<visual name="{item["link"]}_{index}">{body}{material}</visual>'


def _link(facts: RobotFacts, link: LinkFacts, collision: bool) -> str:
    parts = []
    if link.mass > 0.0:
        ixx, iyy, izz, ixy, ixz, iyz = (repr(v) for v in link.inertia)
        parts.append(
            f'<inertial><origin xyz="{numbers(link.com)}" rpy="{numbers(link.rpy)}"/>'
            f'<mass value="{link.mass!r}"/>'
            f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="{ixy}" ixz="{ixz}" iyz="{iyz}"/></inertial>'
        )
    parts += [
        _visual(facts, i)
        for i, item in enumerate(facts.visuals)
        if item["link"] == link.name
    ]
    if collision:
        parts += [
            f'<collision name="{c.link}_capsule_{i}">{_between("capsule", c.p, c.q, c.radius)}</collision>'
            for i, c in enumerate(facts.capsules)
            if c.link == link.name
        ]
    return f'<link name="{link.name}">{"".join(parts)}</link>'


def _joint(joint: JointFacts) -> str:
    frames = (
        f'<origin xyz="{numbers(joint.xyz)}" rpy="{numbers(joint.rpy)}"/>'
        f'<parent link="{joint.parent}"/><child link="{joint.child}"/>'
    )
    if joint.kind == "fixed":
        return f'<joint name="{joint.name}" type="fixed">{frames}</joint>'
    dynamics = f'<dynamics damping="{joint.damping!r}"/>' if joint.damping else ""
    keys = ("effort", "lower", "upper", "velocity")
    values = {key: getattr(joint, key) for key in keys}
    values["drake:acceleration"] = joint.acceleration
    limit = " ".join(
        f'{key}="{value!r}"' for key, value in values.items() if math.isfinite(value)
    )
    return (
        f'<joint name="{joint.name}" type="{joint.kind}">{frames}<axis xyz="{numbers(joint.axis)}"/>'
        f"<limit {limit}/>{dynamics}</joint>"
        f'<transmission name="{joint.name}_transmission">'
        "<type>transmission_interface/SimpleTransmission</type>"
        f'<joint name="{joint.name}"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>'
        f'<actuator name="{joint.name}"><drake:gear_ratio value="{joint.gear_ratio!r}"/>'
        f'<drake:rotor_inertia value="{joint.rotor_inertia!r}"/></actuator></transmission>'
    )


def _filters(facts: RobotFacts) -> list[str]:
    """Collision filter groups of three neighbouring links each, whose capsules overlap
    by construction.
    """
    chain = [facts.base, *(joint.child for joint in facts.joints)]
    solid = [name for name in chain if any(c.link == name for c in facts.capsules)]
    out = []
    for i in range(max(1, len(solid) - 2)):
        members = "".join(f'<drake:member link="{name}"/>' for name in solid[i : i + 3])
        ignored = f'<drake:ignored_collision_filter_group name="neighbours_{i}"/>'
        group = (
            f'<drake:collision_filter_group name="neighbours_{i}">{members}{ignored}'
        )
        out.append(f"{group}</drake:collision_filter_group>")
    return out


def urdf_text(facts: RobotFacts, collision: bool = False) -> str:
    """URDF text of the robot from base to flange, without a tip.

    With ``collision`` it includes capsules for clearances.
    """
    body = [_link(facts, link, collision) for link in facts.links] + [
        _joint(joint) for joint in (*facts.joints, *facts.branches)
    ]
    if collision and facts.capsules:
        body += _filters(facts)
    head = f'<robot name="{facts.name}" xmlns:drake="http://drake.mit.edu">'
    return "\n".join(['<?xml version="1.0"?>', head, *body, "</robot>", ""])
