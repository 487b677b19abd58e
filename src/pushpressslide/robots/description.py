"""Facts of any serial robot, read from its URDF or SDF file: the chain from the root
link to the tip frame.

Kinematics and limits only; dynamics belong to the engine. The common part of SDF is
supported: one model, link poses in the model's frame, joints at their child link.
Convert any other file to URDF.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import (
    MissingFrameError,
    PushPressSlideError,
    RobotFileError,
)
from pushpressslide.robots.facts import (
    JointFacts,
    JointKind,
    RobotFacts,
    rotation_from_rpy,
)
from pushpressslide.robots.file_tree import (
    check_masses,
    check_moving,
    check_tree,
    few,
)
from pushpressslide.robots.file_values import (
    Triple,
    UnfitValue,
    mass,
    moment,
    number,
    place_of,
    product,
    triple,
)

KINDS: dict[str, JointKind] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
MOVING = tuple(kind for kind in KINDS if kind != "fixed")
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
    """Content of a robot's file."""

    name: str | None
    joints: list[JointFacts]
    frames: list[_Frame]
    links: list[str]
    masses: dict[str, float]  # [kg] of links
    mimics: dict[str, str]  # joints that follow others, by name


def read_description(model: str, tip_frame: str | None) -> RobotFacts:
    """Facts of the robot in a URDF or SDF file, with ``tip_frame`` as its flange and
    its tip.

    Raises PushPressSlideError, in one line, if the file is missing, or the tip frame is
    not named or missing. Raises RobotFileError, with link or joint, for values that no
    arm can have.
    """
    path = Path(model)
    if path.suffix.lower() not in (".urdf", ".sdf"):
        raise PushPressSlideError(
            "choose panda, iiwa7, hand, or the path of a .urdf or .sdf file"
        )
    if not path.is_file():
        raise PushPressSlideError("there is no such file")
    if tip_frame is None:
        raise PushPressSlideError(MISSING_TIP_FRAME)
    with _blaming(model):
        return _facts(path, tip_frame)


def _facts(path: Path, tip_frame: str) -> RobotFacts:
    """Checked facts of an existing file."""
    read = _urdf if path.suffix.lower() == ".urdf" else _sdf
    description = read(_root(path))
    check_tree(description.links, description.joints)
    chain = _chain(description, tip_frame)
    link = chain[0].parent if chain else tip_frame
    moving = [joint for joint in chain if joint.kind != "fixed"]
    if not moving:
        raise PushPressSlideError(
            f"no joint moves between its root {link!r} and the tip frame {tip_frame!r}"
        )
    check_moving(moving, description.mimics)
    check_masses(moving, description.joints, description.masses)
    home = tuple(0.5 * (joint.lower + joint.upper) for joint in moving)
    return RobotFacts(
        description.name or path.stem, (), tuple(chain), link, tip_frame, home
    )


@contextmanager
def _blaming(model: str) -> Iterator[None]:
    """Turn errors inside the block into faults of a model's file."""
    try:
        yield
    except UnfitValue as fault:
        raise RobotFileError(
            model, fault.place, fault.value, f"allowed: {fault.allowed}"
        ) from fault
    except MissingFrameError:
        raise
    except PushPressSlideError as error:
        raise RobotFileError(model, "", model, str(error)) from error
    except OSError as error:
        reason = f"it cannot be read ({error.strerror})"
        raise RobotFileError(model, "", model, reason) from error
    except (ValueError, AttributeError, KeyError, TypeError) as error:
        reason = f"it cannot be read ({error})"
        raise RobotFileError(model, "", model, reason) from error


def _root(path: Path) -> Element:
    """Root of a URDF or SDF file."""
    try:
        # Files often use Drake's prefix without declaring it; what it marks is not
        # needed here.
        return ElementTree.fromstring(
            re.sub(r"(</?|\s)drake:", r"\1drake_", path.read_text("utf-8"))
        )
    except (ElementTree.ParseError, UnicodeDecodeError) as error:
        raise PushPressSlideError(f"it is not XML ({error})") from error


def _chain(description: _Description, tip_frame: str) -> list[JointFacts]:
    """Joints from the root link to the tip frame."""
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
    while link in by_child:
        joint = by_child[link]
        if joint.parent == "world":
            break
        chain.append(joint)
        link = joint.parent
    chain.reverse()
    return chain


def _kind(name: str, kind: str) -> JointKind:
    if kind not in KINDS:
        known = f"{', '.join(KINDS)}; one that does not lead to the tip can be fixed"
        raise UnfitValue(f"joint {name!r}, type", kind, known)
    return KINDS[kind]


def _limits(
    name: str, kind: str, values: dict[str, str | None], negative: bool = False
) -> dict[str, float]:
    """Limits of a joint, with positions clipped to a few turns.

    ``negative`` values mean no limit; so does a speed of 0, which is a common
    placeholder.
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
    if negative and effort < 0.0:
        effort = math.inf
    return {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}


def _urdf(root: Element) -> _Description:
    frames = [
        _Frame(
            frame.attrib["name"],
            frame.attrib["link"],
            place_of(frame.get("xyz"), f"frame {frame.attrib['name']!r}, xyz"),
            triple(frame.get("rpy"), f"frame {frame.attrib['name']!r}, rpy"),
        )
        for frame in root.findall("frame")
    ]
    joints = root.findall("joint")
    links = root.findall("link")
    return _Description(
        root.get("name"),
        [_urdf_joint(joint) for joint in joints],
        frames,
        [link.attrib["name"] for link in links],
        {link.attrib["name"]: _urdf_mass(link) for link in links},
        {joint.attrib["name"]: _mimicked(joint) for joint in joints},
    )


def _mimicked(holder: Element) -> str:
    """Name of the joint that a joint mimics, empty for none."""
    mimic = holder.find("mimic")
    return "" if mimic is None else mimic.get("joint") or "another joint"


def _urdf_mass(link: Element) -> float:
    """Mass [kg] of a link. Its inertia and its centre of mass are checked too."""
    name = link.attrib["name"]
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0
    origin = _attributes(inertial.find("origin"))
    place_of(origin.get("xyz"), f"link {name!r}, inertial xyz")
    triple(origin.get("rpy"), f"link {name!r}, inertial rpy")
    inertia = _attributes(inertial.find("inertia"))
    _check_inertia(name, inertia)
    text = _attributes(inertial.find("mass")).get("value")
    return 0.0 if text is None else mass(text, f"link {name!r}, mass")


def _check_inertia(link: str, values: dict[str, str | None]) -> None:
    """Raise UnfitValue for a moment or product of inertia that no body can have."""
    for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
        text = values.get(key)
        judge = moment if key[1] == key[2] else product
        if text is not None:
            judge(text, f"link {link!r}, {key}")


def _urdf_joint(joint: Element) -> JointFacts:
    name = joint.attrib["name"]
    kind = joint.attrib["type"]
    parent = joint.find("parent")
    child = joint.find("child")
    if parent is None or child is None:
        raise ValueError(f"joint {name!r} has no parent or no child")
    limits = {}
    axis = (1.0, 0.0, 0.0)
    if kind in MOVING:
        limits = _limits(name, kind, _attributes(joint.find("limit")))
        place = f"joint {name!r}, axis"
        axis = _unit(
            triple(_attributes(joint.find("axis")).get("xyz"), place, axis), place
        )
    origin = _attributes(joint.find("origin"))
    return JointFacts(
        name,
        _kind(name, kind),
        parent.attrib["link"],
        child.attrib["link"],
        place_of(origin.get("xyz"), f"joint {name!r}, origin xyz"),
        triple(origin.get("rpy"), f"joint {name!r}, origin rpy"),
        axis,
        **limits,
    )


def _attributes(element: Element | None) -> dict[str, str | None]:
    return {} if element is None else dict(element.attrib)


def _unit(axis: Triple, place: str) -> Triple:
    norm = math.hypot(*axis)
    if not 0.0 < norm < math.inf:
        raise UnfitValue(place, list(axis), "a direction, as 0 0 1")
    return (axis[0] / norm, axis[1] / norm, axis[2] / norm)


def _pose(element: Element, place: str) -> tuple[Array, Array]:
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
    xyz, rpy = _six(pose.text or "", place)
    return rotation_from_rpy(rpy), np.array(xyz)


def _six(text: str, place: str) -> tuple[Triple, Triple]:
    """Position [m] and angles [rad] of an SDF pose."""
    words = text.split()
    xyz = place_of(" ".join(words[:3]), f"{place}, pose")
    return xyz, triple(" ".join(words[3:]), f"{place}, pose")


def _rpy(R: Array) -> Triple:
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) < 1e-12:
        return (math.atan2(-R[1, 2], R[1, 1]), pitch, 0.0)
    return (math.atan2(R[2, 1], R[2, 2]), pitch, math.atan2(R[1, 0], R[0, 0]))


def _sdf(root: Element) -> _Description:
    model = root if root.tag == "model" else root.find("model")
    if model is None:
        raise PushPressSlideError("its SDF holds no model")
    links = model.findall("link")
    names = [link.attrib["name"] for link in links]
    poses = {
        name: _pose(link, f"link {name!r}")
        for name, link in zip(names, links, strict=True)
    }
    joints = model.findall("joint")
    return _Description(
        model.get("name"),
        [_sdf_joint(joint, poses) for joint in joints],
        [_sdf_frame(frame) for frame in model.findall("frame")],
        names,
        {link.attrib["name"]: _sdf_mass(link) for link in links},
        {
            joint.attrib["name"]: _mimicked(axis)
            for joint in joints
            if (axis := joint.find("axis")) is not None
        },
    )


def _sdf_mass(link: Element) -> float:
    """Mass [kg] of a link, 1 if the file has none. Its inertia is checked too."""
    name = link.attrib["name"]
    inertial = link.find("inertial")
    if inertial is None:
        return 1.0
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    _check_inertia(name, {key: inertial.findtext(f"inertia/{key}") for key in keys})
    pose = inertial.findtext("pose")
    if (pose or "").strip():
        _six(pose or "", f"link {name!r}, inertial")
    text = inertial.findtext("mass")
    return 1.0 if text is None else mass(text, f"link {name!r}, mass")


def _sdf_joint(joint: Element, poses: dict[str, tuple[Array, Array]]) -> JointFacts:
    """Joint between two links with the given poses in the model."""
    name = joint.attrib["name"]
    kind = joint.attrib["type"]
    parent = (joint.findtext("parent") or "").strip()
    child = (joint.findtext("child") or "").strip()
    if child not in poses:
        raise UnfitValue(f"joint {name!r}, child", child, f"a link: {few(poses)}")
    R_MC, p_MC = poses[child]
    R_MP, p_MP = poses.get(parent, (np.eye(3), np.zeros(3)))
    if joint.find("pose") is not None:
        raise PushPressSlideError(
            f"its joint {name!r} stands off its child link; give it as URDF"
        )
    axis = joint.find("axis")
    limits = {}
    direction = np.array([0.0, 0.0, 1.0])
    if kind in MOVING and axis is not None:
        direction = _sdf_axis(axis, R_MC, f"joint {name!r}, axis")
        keys = ("lower", "upper", "effort", "velocity")
        values = {key: axis.findtext(f"limit/{key}") for key in keys}
        limits = _limits(name, kind, values, negative=True)
    return JointFacts(
        name,
        _kind(name, kind),
        parent,
        child,
        _floats(R_MP.T @ (p_MC - p_MP)),
        _rpy(R_MP.T @ R_MC),
        _unit(_floats(direction), f"joint {name!r}, axis"),
        **limits,
    )


def _sdf_axis(axis: Element, R_MC: Array, place: str) -> Array:
    """Axis (3,) in the child link's frame."""
    xyz = axis.find("xyz")
    if xyz is None:
        return np.array([0.0, 0.0, 1.0])
    direction = np.array(triple(xyz.text, place, (0.0, 0.0, 1.0)))
    if xyz.get("expressed_in") == "__model__":
        direction = R_MC.T @ direction
    return direction


def _sdf_frame(frame: Element) -> _Frame:
    name = frame.attrib["name"]
    xyz, rpy = _six(frame.findtext("pose") or "0 0 0 0 0 0", f"frame {name!r}")
    return _Frame(name, frame.get("attached_to") or "", xyz, rpy)


def _floats(v: Array) -> Triple:
    return (float(v[0]), float(v[1]), float(v[2]))
