"""A robot's SDF file as data: one model, link poses in the model's frame, and joints at
their child links.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.robots.facts import (
    JointFacts,
    LinkFacts,
    rotation_from_rpy,
)
from pushpressslide.robots.file_data import (
    INERTIA,
    KINDS,
    MOVING,
    Description,
    Frame,
    inertia_of,
    kind_of,
    limits_of,
    mimicked,
    rpy_of,
    unit,
)
from pushpressslide.robots.file_shapes import Meshes, ShapeFormat
from pushpressslide.robots.file_tree import few
from pushpressslide.robots.file_values import (
    Triple,
    UnfitValue,
    mass,
    number,
    place_of,
    triple,
)
from pushpressslide.robots.mesh_paths import MeshPaths

NO_INERTIAL = 1.0  # [kg], [kg m^2] of a link without inertial, by the format's rule


def read_sdf(root: Element, file: Path, packages: Sequence[str]) -> Description:
    """Content of an SDF file.

    Raises UnfitValue for a value that no arm can have, and PushPressSlideError for a
    layout that is not supported.
    """
    models = list(root.iter("model"))
    if len(models) != 1:
        raise PushPressSlideError(f"its SDF holds {len(models)} models; allowed: one")
    model = models[0]
    links = model.findall("link")
    names = [link.attrib["name"] for link in links]
    poses = {
        name: _pose(link, f"link {name!r}")
        for name, link in zip(names, links, strict=True)
    }
    joints = model.findall("joint")
    meshes = Meshes(MeshPaths(file, packages))
    form = ShapeFormat(Element.findtext, "uri", _shape_pose, _color)
    kinds = {joint.attrib["name"]: joint.attrib["type"] for joint in joints}
    return Description(
        model.get("name"),
        [_link(link) for link in links],
        [_joint(joint, poses) for joint in joints],
        [_frame(frame) for frame in model.findall("frame")],
        [shape for link in links for shape in form.shapes(link, meshes)],
        {
            joint.attrib["name"]: mimicked(axis)
            for joint in joints
            if (axis := joint.find("axis")) is not None
        },
        {name: kind for name, kind in kinds.items() if kind not in KINDS},
        meshes.notes(),
    )


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
    words = text.split() or ["0"] * 6
    xyz = place_of(" ".join(words[:3]), f"{place}, pose")
    return xyz, triple(" ".join(words[3:]), f"{place}, pose")


def _link(link: Element) -> LinkFacts:
    name = link.attrib["name"]
    inertial = link.find("inertial")
    if inertial is None:
        inertia = inertia_of(name, {}, NO_INERTIAL)
        return LinkFacts(name, NO_INERTIAL, inertia=inertia)
    values = {key: inertial.findtext(f"inertia/{key}") for key in INERTIA}
    inertia = inertia_of(name, values, NO_INERTIAL)
    com, rpy = _six(inertial.findtext("pose") or "", f"link {name!r}, inertial")
    text = inertial.findtext("mass")
    own = NO_INERTIAL if text is None else mass(text, f"link {name!r}, mass")
    return LinkFacts(name, own, com, rpy, inertia)


def _joint(joint: Element, poses: dict[str, tuple[Array, Array]]) -> JointFacts:
    """Joint between two links, whose ``poses`` are in the model's frame."""
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
    direction: Triple = (0.0, 0.0, 1.0)
    if kind in MOVING and axis is not None:
        place = f"joint {name!r}, axis"
        direction = unit(_axis(axis, R_MC, place), place)
        keys = ("lower", "upper", "effort", "velocity")
        values = {key: axis.findtext(f"limit/{key}") for key in keys}
        limits = limits_of(name, kind, values, negative=True) | _motor(axis, joint)
    return JointFacts(
        name,
        kind_of(kind),
        parent,
        child,
        _floats(R_MP.T @ (p_MC - p_MP)),
        rpy_of(R_MP.T @ R_MC),
        direction,
        **limits,
    )


def _motor(axis: Element, joint: Element) -> dict[str, float]:
    """Damping of a joint, and its motor's properties from Drake's tags."""
    name = joint.attrib["name"]
    texts = {
        "damping": axis.findtext("dynamics/damping"),
        "gear_ratio": joint.findtext("drake_gear_ratio"),
        "rotor_inertia": joint.findtext("drake_rotor_inertia"),
    }
    return {
        key: number(text, f"joint {name!r}, {key}", "0 or more", lambda v: v >= 0.0)
        for key, text in texts.items()
        if text is not None
    }


def _axis(axis: Element, R_MC: Array, place: str) -> Triple:
    """Axis in the child link's frame."""
    xyz = axis.find("xyz")
    if xyz is None:
        return (0.0, 0.0, 1.0)
    direction = np.array(triple(xyz.text, place, (0.0, 0.0, 1.0)))
    if xyz.get("expressed_in") == "__model__":
        direction = R_MC.T @ direction
    return _floats(direction)


def _frame(frame: Element) -> Frame:
    name = frame.attrib["name"]
    xyz, rpy = _six(frame.findtext("pose") or "", f"frame {name!r}")
    return Frame(name, frame.get("attached_to") or "", xyz, rpy)


def _shape_pose(holder: Element, place: str) -> tuple[Triple, Triple]:
    return _six(holder.findtext("pose") or "", place)


def _color(holder: Element) -> Triple | None:
    values = (holder.findtext("material/diffuse") or "").split()[:3]
    try:
        r, g, b = map(float, values)
    except ValueError:
        return None
    return (r, g, b)


def _floats(v: Array) -> Triple:
    return (float(v[0]), float(v[1]), float(v[2]))
