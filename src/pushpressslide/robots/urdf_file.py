"""A robot's URDF file as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element

from pushpressslide.robots.facts import JointFacts, LinkFacts
from pushpressslide.robots.file_data import (
    KINDS,
    MOVING,
    Description,
    Frame,
    inertia_of,
    kind_of,
    limits_of,
    mimicked,
    unit,
)
from pushpressslide.robots.file_shapes import Meshes, ShapeFormat
from pushpressslide.robots.file_values import (
    Triple,
    mass,
    number,
    place_of,
    triple,
)
from pushpressslide.robots.mesh_paths import MeshPaths


def read_urdf(root: Element, file: Path, packages: Sequence[str]) -> Description:
    """Content of a URDF file.

    Raises UnfitValue for a value that no arm can have, and KeyError or ValueError for a
    missing name.
    """
    joints = root.findall("joint")
    links = root.findall("link")
    meshes = Meshes(MeshPaths(file, packages))
    colors = {
        material.get("name", ""): _color(material)
        for material in root.findall("material")
    }
    rotors = dict(map(_rotor, root.findall("transmission")))
    form = ShapeFormat(
        Element.get, "filename", _shape_pose, partial(_shape_color, colors)
    )
    shapes = [shape for link in links for shape in form.shapes(link, meshes)]
    return Description(
        root.get("name"),
        [_link(link) for link in links],
        [_joint(joint, rotors.get(joint.attrib["name"], {})) for joint in joints],
        [_frame(frame) for frame in root.findall("frame")],
        shapes,
        {joint.attrib["name"]: mimicked(joint) for joint in joints},
        {
            joint.attrib["name"]: joint.attrib["type"]
            for joint in joints
            if joint.attrib["type"] not in KINDS
        },
        meshes.notes(),
    )


def _frame(frame: Element) -> Frame:
    name = frame.attrib["name"]
    return Frame(
        name,
        frame.attrib["link"],
        place_of(frame.get("xyz"), f"frame {name!r}, xyz"),
        triple(frame.get("rpy"), f"frame {name!r}, rpy"),
    )


def _link(link: Element) -> LinkFacts:
    name = link.attrib["name"]
    inertial = link.find("inertial")
    if inertial is None:
        return LinkFacts(name)
    origin = attributes(inertial.find("origin"))
    com = place_of(origin.get("xyz"), f"link {name!r}, inertial xyz")
    rpy = triple(origin.get("rpy"), f"link {name!r}, inertial rpy")
    inertia = inertia_of(name, attributes(inertial.find("inertia")), 0.0)
    text = attributes(inertial.find("mass")).get("value")
    own = 0.0 if text is None else mass(text, f"link {name!r}, mass")
    return LinkFacts(name, own, com, rpy, inertia)


def _rotor(transmission: Element) -> tuple[str, dict[str, float]]:
    """Joint of a transmission, and its motor's properties from Drake's tags."""
    joint = transmission.find("joint")
    name = "" if joint is None else joint.get("name") or ""
    out = {}
    for actuator in transmission.findall("actuator"):
        for key in ("gear_ratio", "rotor_inertia"):
            text = attributes(actuator.find(f"drake_{key}")).get("value")
            if text is not None:
                place = f"joint {name!r}, {key}"
                out[key] = number(text, place, "0 or more", lambda v: 0.0 <= v < 1e6)
    return name, out


def _joint(joint: Element, rotor: Mapping[str, float]) -> JointFacts:
    name = joint.attrib["name"]
    kind = joint.attrib["type"]
    parent = joint.find("parent")
    child = joint.find("child")
    if parent is None or child is None:
        raise ValueError(f"joint {name!r} has no parent or no child")
    limits: dict[str, float] = {}
    axis = (1.0, 0.0, 0.0)
    if kind in MOVING:
        limits = limits_of(name, kind, attributes(joint.find("limit"))) | dict(rotor)
        damping = attributes(joint.find("dynamics")).get("damping")
        if damping is not None:
            place = f"joint {name!r}, damping"
            limits["damping"] = number(damping, place, "0 or more", lambda v: v >= 0.0)
        place = f"joint {name!r}, axis"
        axis = unit(
            triple(attributes(joint.find("axis")).get("xyz"), place, axis), place
        )
    origin = attributes(joint.find("origin"))
    return JointFacts(
        name,
        kind_of(kind),
        parent.attrib["link"],
        child.attrib["link"],
        place_of(origin.get("xyz"), f"joint {name!r}, origin xyz"),
        triple(origin.get("rpy"), f"joint {name!r}, origin rpy"),
        axis,
        **limits,
    )


def attributes(element: Element | None) -> dict[str, str | None]:
    """Attributes of an element, or an empty dictionary if the element is missing."""
    return {} if element is None else dict(element.attrib)


def _color(material: Element) -> Triple | None:
    """Colour of a material element, or None."""
    color = material.find("color")
    values = (color.get("rgba") or "").split()[:3] if color is not None else []
    try:
        r, g, b = map(float, values)
    except ValueError:
        return None
    return (r, g, b)


def _shape_color(colors: Mapping[str, Triple | None], holder: Element) -> Triple | None:
    """Colour of a shape: its own, or that of the material it refers to."""
    material = holder.find("material")
    if material is None:
        return None
    return _color(material) or colors.get(material.get("name", ""))


def _shape_pose(holder: Element, place: str) -> tuple[Triple, Triple]:
    origin = attributes(holder.find("origin"))
    xyz = place_of(origin.get("xyz"), f"{place}, xyz")
    return xyz, triple(origin.get("rpy"), f"{place}, rpy")
