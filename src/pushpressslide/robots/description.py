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
from numpy.typing import NDArray

from pushpressslide.core.errors import MissingFrameError, PushPressSlideError
from pushpressslide.robots.facts import (
    JointFacts,
    JointKind,
    RobotFacts,
    rotation_from_rpy,
)

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
KINDS: dict[str, JointKind] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
TURNS = 2.0 * math.pi  # [rad] limit taken for a joint that turns without end


@dataclass(frozen=True)
class _Frame:
    name: str
    parent: str
    xyz: Triple
    rpy: Triple


def read_description(model: str, tip_frame: str | None) -> RobotFacts:
    """Return the facts of the robot in a URDF or SDF file, with ``tip_frame`` as its
    flange and its tip.

    Raises PushPressSlideError, in one line, if the file is missing or cannot be read,
    if the tip frame is not named or not there, or if the chain to it has a joint of a
    kind that is not known.
    """
    path = Path(model)
    if path.suffix.lower() not in (".urdf", ".sdf"):
        raise PushPressSlideError(
            "choose panda, iiwa7, hand, or the path of a .urdf or .sdf file"
        )
    if not path.is_file():
        raise PushPressSlideError("there is no such file")
    try:
        # Files often use Drake's prefix without declaring it; what it marks is not
        # needed here.
        root = ElementTree.fromstring(
            re.sub(r"(</?|\s)drake:", r"\1drake_", path.read_text("utf-8"))
        )
    except (ElementTree.ParseError, UnicodeDecodeError) as error:
        raise PushPressSlideError(f"it is not XML ({error})") from error
    if tip_frame is None:
        raise PushPressSlideError(
            "a model given by path needs tip_frame, the name of the frame at the tip's "
            "centre"
        )
    try:
        if path.suffix.lower() == ".urdf":
            joints, frames, links = _urdf(root)
        else:
            joints, frames, links = _sdf(root)
        return _facts(root, path, joints, frames, links, tip_frame)
    except (ValueError, AttributeError, KeyError, TypeError) as error:
        raise PushPressSlideError(f"it cannot be read ({error})") from error


def _facts(
    root: Element,
    path: Path,
    joints: list[JointFacts],
    frames: list[_Frame],
    links: list[str],
    tip_frame: str,
) -> RobotFacts:
    by_child = {joint.child: joint for joint in joints}
    chain: list[JointFacts] = []
    link = tip_frame
    for frame in frames:
        if frame.name == tip_frame:
            chain.append(
                JointFacts(
                    f"{tip_frame}_mount",
                    "fixed",
                    frame.parent,
                    tip_frame,
                    frame.xyz,
                    frame.rpy,
                )
            )
            link = frame.parent
    if link not in links:
        known = ", ".join([*links, *(frame.name for frame in frames)])
        raise MissingFrameError(
            f"it has no frame {tip_frame!r}; there are {known[:300]}"
        )
    while (
        link in by_child
        and by_child[link].parent != "world"
        and len(chain) <= len(joints)
    ):
        chain.append(by_child[link])
        link = by_child[link].parent
    chain.reverse()
    moving = [joint for joint in chain if joint.kind != "fixed"]
    if not moving:
        raise PushPressSlideError(
            f"no joint moves between its root {link!r} and the tip frame {tip_frame!r}"
        )
    home = tuple(0.5 * (joint.lower + joint.upper) for joint in moving)
    return RobotFacts(
        root.get("name") or path.stem, (), tuple(chain), link, tip_frame, home
    )


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


def _urdf(root: Element) -> tuple[list[JointFacts], list[_Frame], list[str]]:
    joints = []
    for joint in root.findall("joint"):
        name = joint.attrib["name"]
        kind = joint.attrib["type"]
        parent = joint.find("parent")
        child = joint.find("child")
        origin = joint.find("origin")
        if parent is None or child is None:
            raise ValueError(f"joint {name!r} lacks its parent or child")
        xyz, rpy = (
            _triple(None if origin is None else origin.get(key))
            for key in ("xyz", "rpy")
        )
        axis = joint.find("axis")
        limit = joint.find("limit")
        limits = (
            _limits(kind, {} if limit is None else dict(limit.attrib))
            if kind != "fixed"
            else {}
        )
        a = _triple(None if axis is None else axis.get("xyz"), (1.0, 0.0, 0.0))
        joints.append(
            JointFacts(
                name,
                _kind(name, kind),
                parent.attrib["link"],
                child.attrib["link"],
                xyz,
                rpy,
                _unit(a),
                **limits,
            )
        )
    frames = [
        _Frame(
            f.attrib["name"],
            f.attrib["link"],
            _triple(f.get("xyz")),
            _triple(f.get("rpy")),
        )
        for f in root.findall("frame")
    ]
    return joints, frames, [link.attrib["name"] for link in root.findall("link")]


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


def _sdf(root: Element) -> tuple[list[JointFacts], list[_Frame], list[str]]:
    model = root if root.tag == "model" else root.find("model")
    if model is None:
        raise PushPressSlideError("its SDF holds no model")
    root.set("name", model.get("name") or "")
    poses = {link.attrib["name"]: _pose(link) for link in model.findall("link")}
    joints = []
    for joint in model.findall("joint"):
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
        a = np.array([0.0, 0.0, 1.0])
        if kind != "fixed" and axis is not None:
            xyz = axis.find("xyz")
            a = np.array(_triple(None if xyz is None else xyz.text, (0.0, 0.0, 1.0)))
            if xyz is not None and xyz.get("expressed_in") == "__model__":
                a = R_MC.T @ a
            keys = ("lower", "upper", "effort", "velocity")
            limits = _limits(kind, {key: axis.findtext(f"limit/{key}") for key in keys})
        p = R_MP.T @ (p_MC - p_MP)
        xyz_PC: Triple = (float(p[0]), float(p[1]), float(p[2]))
        unit = _unit((float(a[0]), float(a[1]), float(a[2])))
        joints.append(
            JointFacts(
                name,
                _kind(name, kind),
                parent,
                child,
                xyz_PC,
                _rpy(R_MP.T @ R_MC),
                unit,
                **limits,
            )
        )
    frames = []
    for frame in model.findall("frame"):
        attached = frame.get("attached_to") or ""
        pose = frame.find("pose")
        given = [
            float(x)
            for x in (
                (pose.text if pose is not None else None) or "0 0 0 0 0 0"
            ).split()
        ]
        frames.append(
            _Frame(
                frame.attrib["name"],
                attached,
                (given[0], given[1], given[2]),
                (given[3], given[4], given[5]),
            )
        )
    return joints, frames, list(poses)
