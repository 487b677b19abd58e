"""Facts of any serial robot, read from its URDF or SDF file: the chain from the root
link to the tip frame.

Kinematics and limits only; dynamics are the engine's business. Of SDF the common part
is read: one model, link poses in the model's frame, joints at their child link. For
anything else convert the file to URDF.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingFrameError, PushPressSlideError
from pushpressslide.robots.facts import (
    JointFacts,
    JointKind,
    RobotFacts,
    rotation_from_rpy,
)

Triple = tuple[float, float, float]
KINDS: dict[str, JointKind] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
MISSING_TIP_FRAME = (
    "a model given by path needs tip_frame, the name of the frame at the tip's centre"
)
TURNS = 2.0 * math.pi  # [rad] limit taken for a joint that turns without end


@dataclass(frozen=True)
class _Frame:
    name: str
    parent: str
    xyz: Triple
    rpy: Triple


@dataclass(frozen=True)
class _Description:
    """What a file describes."""

    name: str | None
    joints: list[JointFacts]
    frames: list[_Frame]
    links: list[str]


def read_description(model: str, tip_frame: str | None) -> RobotFacts:
    """Return the facts of the robot in a URDF or SDF file, with ``tip_frame`` as its
    flange and its tip.

    Raises PushPressSlideError, in one line, if the file is missing or cannot be read,
    if the tip frame is not named or not there, or if the chain to it has a joint of a
    kind that is not known.
    """
    path = Path(model)
    root = _root(path)
    if tip_frame is None:
        raise PushPressSlideError(MISSING_TIP_FRAME)
    try:
        read = _urdf if path.suffix.lower() == ".urdf" else _sdf
        description = read(root)
        chain = _chain(description, tip_frame)
    except (ValueError, AttributeError, KeyError, TypeError) as error:
        raise PushPressSlideError(f"it cannot be read ({error})") from error
    link = chain[0].parent if chain else tip_frame
    moving = [joint for joint in chain if joint.kind != "fixed"]
    if not moving:
        raise PushPressSlideError(
            f"no joint moves between its root {link!r} and the tip frame {tip_frame!r}"
        )
    home = tuple(0.5 * (joint.lower + joint.upper) for joint in moving)
    return RobotFacts(
        description.name or path.stem, (), tuple(chain), link, tip_frame, home
    )


def _root(path: Path) -> Element:
    """Return the root of a URDF or SDF file."""
    if path.suffix.lower() not in (".urdf", ".sdf"):
        raise PushPressSlideError(
            "choose panda, iiwa7, hand, or the path of a .urdf or .sdf file"
        )
    if not path.is_file():
        raise PushPressSlideError("there is no such file")
    try:
        # Files often use Drake's prefix without declaring it; what it marks is not
        # needed here.
        return ElementTree.fromstring(
            re.sub(r"(</?|\s)drake:", r"\1drake_", path.read_text("utf-8"))
        )
    except (ElementTree.ParseError, UnicodeDecodeError) as error:
        raise PushPressSlideError(f"it is not XML ({error})") from error


def _chain(description: _Description, tip_frame: str) -> list[JointFacts]:
    """Return the joints from the root link to the tip frame."""
    chain: list[JointFacts] = []
    link = tip_frame
    for frame in description.frames:
        if frame.name == tip_frame:
            mount = f"{tip_frame}_mount"
            chain.append(
                JointFacts(
                    mount, "fixed", frame.parent, tip_frame, frame.xyz, frame.rpy
                )
            )
            link = frame.parent
    if link not in description.links:
        names = [*description.links, *(frame.name for frame in description.frames)]
        known = ", ".join(names)
        raise MissingFrameError(
            f"it has no frame {tip_frame!r}; there are {known[:300]}"
        )
    by_child = {joint.child: joint for joint in description.joints}
    longest = len(description.joints)  # a longer chain goes round in a circle
    while link in by_child and len(chain) <= longest:
        joint = by_child[link]
        if joint.parent == "world":
            break
        chain.append(joint)
        link = joint.parent
    chain.reverse()
    return chain


def _triple(text: str | None, default: Triple = (0.0, 0.0, 0.0)) -> Triple:
    if text is None:
        return default
    x, y, z = (float(v) for v in text.split())
    return (x, y, z)


def _kind(name: str, kind: str) -> JointKind:
    if kind not in KINDS:
        raise PushPressSlideError(
            f"its joint {name!r} is of kind {kind!r}; known are {', '.join(KINDS)}"
        )
    return KINDS[kind]


def _limits(kind: str, values: dict[str, str | None]) -> dict[str, float]:
    def value(key: str, default: float) -> float:
        """Return a limit, or what stands for one that is not given."""
        text = values.get(key)
        return default if text is None else float(text)

    lower = value("lower", -TURNS)
    upper = value("upper", TURNS)
    if kind == "continuous" or not lower < upper:
        lower = -TURNS
        upper = TURNS
    lower = max(lower, -4.0 * TURNS)
    upper = min(upper, 4.0 * TURNS)
    effort = value("effort", math.inf)
    velocity = value("velocity", math.inf)
    # A negative limit means none in SDF, and so does a zero that somebody left in.
    effort, velocity = (math.inf if v <= 0.0 else v for v in (effort, velocity))
    return {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}


def _urdf(root: Element) -> _Description:
    frames = [
        _Frame(
            frame.attrib["name"],
            frame.attrib["link"],
            _triple(frame.get("xyz")),
            _triple(frame.get("rpy")),
        )
        for frame in root.findall("frame")
    ]
    return _Description(
        root.get("name"),
        [_urdf_joint(joint) for joint in root.findall("joint")],
        frames,
        [link.attrib["name"] for link in root.findall("link")],
    )


def _urdf_joint(joint: Element) -> JointFacts:
    name = joint.attrib["name"]
    kind = joint.attrib["type"]
    parent = joint.find("parent")
    child = joint.find("child")
    if parent is None or child is None:
        raise ValueError(f"joint {name!r} lacks its parent or child")
    limits = {}
    if kind != "fixed":
        limits = _limits(kind, _attributes(joint.find("limit")))
    origin = _attributes(joint.find("origin"))
    axis = _attributes(joint.find("axis"))
    return JointFacts(
        name,
        _kind(name, kind),
        parent.attrib["link"],
        child.attrib["link"],
        _triple(origin.get("xyz")),
        _triple(origin.get("rpy")),
        _unit(_triple(axis.get("xyz"), (1.0, 0.0, 0.0))),
        **limits,
    )


def _attributes(element: Element | None) -> dict[str, str | None]:
    return {} if element is None else dict(element.attrib)


def _unit(axis: Triple) -> Triple:
    norm = math.sqrt(sum(v * v for v in axis))
    if norm == 0.0:
        raise ValueError("a joint axis is zero")
    return (axis[0] / norm, axis[1] / norm, axis[2] / norm)


def _pose(element: Element) -> tuple[Array, Array]:
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return np.eye(3), np.zeros(3)
    if (
        pose.get("relative_to") not in (None, "__model__")
        or pose.get("rotation_format") == "quat_xyzw"
    ):
        raise PushPressSlideError(
            "its SDF poses are relative to other frames; give it as URDF"
        )
    v = [float(x) for x in (pose.text or "").split()]
    return rotation_from_rpy((v[3], v[4], v[5])), np.array(v[:3])


def _rpy(R: Array) -> Triple:
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) < 1e-12:
        return (math.atan2(-R[1, 2], R[1, 1]), pitch, 0.0)
    return (math.atan2(R[2, 1], R[2, 2]), pitch, math.atan2(R[1, 0], R[0, 0]))


def _sdf(root: Element) -> _Description:
    model = root if root.tag == "model" else root.find("model")
    if model is None:
        raise PushPressSlideError("its SDF holds no model")
    poses = {link.attrib["name"]: _pose(link) for link in model.findall("link")}
    return _Description(
        model.get("name"),
        [_sdf_joint(joint, poses) for joint in model.findall("joint")],
        [_sdf_frame(frame) for frame in model.findall("frame")],
        list(poses),
    )


def _sdf_joint(joint: Element, poses: dict[str, tuple[Array, Array]]) -> JointFacts:
    """Return a joint between two links, whose poses in the model are given."""
    name = joint.attrib["name"]
    kind = joint.attrib["type"]
    parent = (joint.findtext("parent") or "").strip()
    child = (joint.findtext("child") or "").strip()
    R_MC, p_MC = poses[child]
    R_MP, p_MP = poses.get(parent, (np.eye(3), np.zeros(3)))
    if joint.find("pose") is not None:
        raise PushPressSlideError(
            f"its joint {name!r} stands off its child link; give it as URDF"
        )
    axis = joint.find("axis")
    limits = {}
    direction = np.array([0.0, 0.0, 1.0])
    if kind != "fixed" and axis is not None:
        direction = _sdf_axis(axis, R_MC)
        keys = ("lower", "upper", "effort", "velocity")
        limits = _limits(kind, {key: axis.findtext(f"limit/{key}") for key in keys})
    return JointFacts(
        name,
        _kind(name, kind),
        parent,
        child,
        _floats(R_MP.T @ (p_MC - p_MP)),
        _rpy(R_MP.T @ R_MC),
        _unit(_floats(direction)),
        **limits,
    )


def _sdf_axis(axis: Element, R_MC: Array) -> Array:
    """Return the axis (3,) in the child link's frame."""
    xyz = axis.find("xyz")
    if xyz is None:
        return np.array([0.0, 0.0, 1.0])
    direction = np.array(_triple(xyz.text, (0.0, 0.0, 1.0)))
    if xyz.get("expressed_in") == "__model__":
        direction = R_MC.T @ direction
    return direction


def _sdf_frame(frame: Element) -> _Frame:
    numbers = (frame.findtext("pose") or "0 0 0 0 0 0").split()
    x, y, z, roll, pitch, yaw = (float(number) for number in numbers[:6])
    attached = frame.get("attached_to") or ""
    return _Frame(frame.attrib["name"], attached, (x, y, z), (roll, pitch, yaw))


def _floats(v: Array) -> Triple:
    return (float(v[0]), float(v[1]), float(v[2]))
