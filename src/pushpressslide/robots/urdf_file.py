"""A robot's URDF file as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from pushpressslide.robots.facts import JointFacts, LinkFacts, LinkShape, ShapeKind
from pushpressslide.robots.file_data import (
    KINDS,
    MOVING,
    Description,
    Frame,
    Lost,
    inertia_of,
    kind_of,
    left_out,
    limits_of,
    mimicked,
    unit,
)
from pushpressslide.robots.file_values import (
    Triple,
    mass,
    number,
    place_of,
    triple,
)
from pushpressslide.robots.mesh_paths import MeshPaths, readable


def read_urdf(root: Element, file: Path, packages: Sequence[str]) -> Description:
    """Content of a URDF file.

    Raises UnfitValue for a value that no arm can have, and KeyError or ValueError for a
    missing name.
    """
    joints = root.findall("joint")
    links = root.findall("link")
    paths = MeshPaths(file, packages)
    colors = {
        material.get("name", ""): _color(material)
        for material in root.findall("material")
    }
    rotors = dict(map(_rotor, root.findall("transmission")))
    lost: Lost = []
    shapes = [shape for link in links for shape in _shapes(link, paths, colors, lost)]
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
        left_out(lost),
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
    """Joint of a transmission, and what Drake's tags say of its motor."""
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


def _color(material: Element | None) -> Triple | None:
    """Colour that a material element states, or None."""
    color = None if material is None else material.find("color")
    values = (color.get("rgba") or "").split()[:3] if color is not None else []
    try:
        r, g, b = map(float, values)
    except ValueError:
        return None
    return (r, g, b)


def _shapes(
    link: Element,
    paths: MeshPaths,
    colors: Mapping[str, Triple | None],
    lost: Lost,
) -> Iterator[LinkShape]:
    """Shapes of a link. Adds meshes that are not found to ``lost``."""
    name = link.attrib["name"]
    for holder in (*link.findall("collision"), *link.findall("visual")):
        geometry = holder.find("geometry")
        if geometry is None or not len(geometry):
            continue
        solid = holder.tag == "collision"
        origin = attributes(holder.find("origin"))
        place = f"link {name!r}, {holder.tag}"
        material = holder.find("material")
        color = _color(material)
        if color is None and material is not None:
            color = colors.get(material.get("name", ""))
        shape = _shape(geometry[0], place)
        mesh = ""
        if shape is None:
            lost.append(("of an unknown kind", geometry[0].tag))
            continue
        if shape[0] == "mesh":
            uri = geometry[0].get("filename") or ""
            path = paths.find(uri)
            if path is None or not readable(path):
                reason = "not found" if path is None else "which pycollada reads"
                lost.append((reason, uri))
                continue
            mesh = str(path)
        yield LinkShape(
            name,
            *shape,
            place_of(origin.get("xyz"), f"{place}, xyz"),
            triple(origin.get("rpy"), f"{place}, rpy"),
            solid,
            mesh,
            color,
        )


def _shape(geometry: Element, place: str) -> tuple[ShapeKind, tuple[float, ...]] | None:
    """Kind and size of a geometry. None for an unknown kind."""
    kind = geometry.tag.split("}")[-1].removeprefix("drake_")

    def size(key: str) -> float:
        """A length [m] above zero."""
        allowed = "a number [m] above 0"
        return number(
            geometry.get(key) or "", f"{place}, {key}", allowed, lambda v: 0.0 < v < 1e3
        )

    if kind == "box":
        return "box", triple(geometry.get("size") or "", f"{place}, size")
    if kind == "sphere":
        return "sphere", (size("radius"),)
    if kind == "cylinder":
        return "cylinder", (size("radius"), size("length"))
    if kind == "capsule":
        return "capsule", (size("radius"), size("length"))
    if kind == "mesh":
        return "mesh", triple(geometry.get("scale"), f"{place}, scale", (1.0, 1.0, 1.0))
    return None
