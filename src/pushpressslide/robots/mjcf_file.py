"""A robot's MJCF file as data, read in the same way as MuJoCo compiles it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.facts import JointFacts, JointKind, LinkFacts, LinkShape
from pushpressslide.robots.file_data import (
    Description,
    Frame,
    limits_of,
    rpy_of,
    unit,
)
from pushpressslide.robots.file_shapes import Meshes
from pushpressslide.robots.file_tree import WORLD
from pushpressslide.robots.file_values import Triple, UnfitValue, number, vector
from pushpressslide.robots.mesh_paths import MeshPaths
from pushpressslide.robots.mjcf_model import MAIN, Body, Model, Part
from pushpressslide.robots.mjcf_shapes import (
    Geom,
    geom_of,
    link_of,
    mesh_assets,
    triple_of,
)

FREE = "free"
BALL = "ball"


def read_mjcf(root: Element, file: Path, packages: Sequence[str]) -> Description:
    """Content of an MJCF file.

    Raises UnfitValue for a value that no arm can have, and PushPressSlideError for
    elements that are not supported.
    """
    paths = MeshPaths(file, packages)
    model = Model.from_file(root, paths)
    meshes = Meshes(paths)
    assets = mesh_assets(model, meshes)
    links: list[LinkFacts] = []
    joints: list[JointFacts] = []
    frames: list[Frame] = []
    shapes: list[LinkShape] = []
    odd: dict[str, str] = {}
    notes: list[str] = []
    efforts = _efforts(model)
    bodies = model.bodies()
    for body in bodies:
        parts = body.parts_of_kind("geom")
        read = [geom_of(part, model, assets, meshes) for part in parts]
        geoms = [geom for geom in read if geom is not None]
        links.append(link_of(body, model, geoms))
        shapes += _shapes(body, model, geoms)
        chain = _joints(body, model, efforts, odd, notes)
        chain = [joint for joint in chain if not _is_root(joint, bodies)]
        joints += chain
        links += [LinkFacts(j.child) for j in chain if j.child != body.name]
        frames += _frames(body)
    names = {link.name for link in links}
    return Description(
        root.get("model"),
        links,
        joints,
        [frame for frame in frames if frame.name not in names],
        shapes,
        _coupled(model),
        odd,
        [*notes, *meshes.notes()],
    )


def _is_root(joint: JointFacts, bodies: Sequence[Body]) -> bool:
    """Whether a joint fixes the only body of the world at the world's origin."""
    alone = sum(not body.parent for body in bodies) == 1
    at_origin = not any((*joint.xyz, *joint.rpy))
    return alone and joint.parent == WORLD and joint.kind == "fixed" and at_origin


def _frames(body: Body) -> Iterator[Frame]:
    """Yield the sites of a body as frames."""
    for part in body.parts_of_kind("site"):
        R, p = part.X
        if "name" in part.values:
            yield Frame(part.values["name"], body.name, triple_of(p), rpy_of(R))


def _shapes(body: Body, model: Model, geoms: Sequence[Geom]) -> Iterator[LinkShape]:
    """Yield the shapes of a body, one for each geom."""
    for geom in geoms:
        shape = geom.shape
        if shape is not None:
            color = _color(model, geom.values)
            yield replace(shape, link=body.name, color=color)


def _color(model: Model, values: Mapping[str, str]) -> Triple | None:
    """Colour of a geom: its own, or that of its material."""
    text = values.get("rgba")
    if text is None and "material" in values:
        for material in model.root.findall("asset/material"):
            if material.get("name") == values["material"]:
                text = model.values(material, MAIN).get("rgba")
    words = (text or "").split()[:3]
    try:
        r, g, b = map(float, words)
    except ValueError:
        return None
    return (r, g, b)


def _joints(
    body: Body,
    model: Model,
    efforts: Mapping[str, float],
    odd: dict[str, str],
    notes: list[str],
) -> list[JointFacts]:
    """Joints from a body's parent to the body.

    A fixed joint is added if the body has no joint, or if its frame is not at its last
    joint. Joints that cannot be driven are added to ``odd``.
    """
    parent = body.parent or WORLD
    out: list[JointFacts] = []
    R, p = body.X
    origin = np.zeros(3)  # of the frame so far, in the body's frame
    parts = [
        part
        for part in body.parts_of_kind("joint", "freejoint")
        if not _is_free(part, body, notes)
    ]
    for i, part in enumerate(parts):
        name = part.values.get("name") or f"{body.name}_joint_{i}"
        kind = part.values.get("type", "hinge")
        anchor = _anchor(part)
        last = i == len(parts) - 1 and not anchor.any()
        child = body.name if last else f"{body.name}_{name}"
        xyz = triple_of(p + R @ (anchor - origin))
        frame = JointFacts(name, "fixed", parent, child, xyz, rpy_of(R))
        if kind == BALL:
            odd[name] = BALL
            out.append(frame)
        else:
            out.append(_driven(frame, part, model, efforts))
        if "ref" in part.values:
            notes.append(f"joint {name}: its zero is the ref of the file")
        parent, R, p, origin = child, np.eye(3), np.zeros(3), anchor
    if parent != body.name:
        xyz = triple_of(p - R @ origin)
        name = f"{body.name}_weld"
        out.append(JointFacts(name, "fixed", parent, body.name, xyz, rpy_of(R)))
    return out


def _is_free(part: Part, body: Body, notes: list[str]) -> bool:
    """Whether a joint leaves its body free, as at a robot's base. A note is added if
    so.

    Raises UnfitValue for such a joint at any other body.
    """
    kind = part.values.get("type", part.element.tag)
    if kind not in (FREE, "freejoint"):
        return False
    if body.parent:
        raise UnfitValue(f"{part.place}, type", FREE, "only on the base")
    notes.append(f"left out: free {part.place}; the task says where the base is")
    return True


def _anchor(part: Part) -> Array:
    """Position (3,) [m] of a joint in its body's frame."""
    R, p = part.X
    place = f"{part.place}, pos"
    out: Array = p + R @ np.array(vector(part.values.get("pos"), 3, place, (0.0,) * 3))
    return out


def _driven(
    frame: JointFacts, part: Part, model: Model, efforts: Mapping[str, float]
) -> JointFacts:
    """A hinge or slide in place of a fixed joint."""
    values = part.values
    place = f"joint {frame.name!r}"
    turns = values.get("type", "hinge") == "hinge"
    text = values.get("axis", "0 0 1")
    axis = part.X[0] @ np.array(vector(text, 3, f"{place}, axis"))
    texts: dict[str, str | None] = {}
    if model.is_limited(values):
        ends = vector(values["range"], 2, f"{place}, range")
        ref = _number(values, "ref", place)
        low, high = (model.angle(v - ref) if turns else v - ref for v in ends)
        texts = {"lower": repr(low), "upper": repr(high)}
    if frame.name in efforts:
        texts["effort"] = repr(efforts[frame.name])
    kind: JointKind = "revolute" if turns else "prismatic"
    endless = turns and "lower" not in texts
    limits = limits_of(frame.name, "continuous" if endless else kind, texts)
    return replace(
        frame,
        kind=kind,
        axis=unit(triple_of(axis), f"{place}, axis"),
        lower=limits["lower"],
        upper=limits["upper"],
        effort=limits["effort"],
        rotor_inertia=_number(values, "armature", place),
        damping=_number(values, "damping", place),
    )


def _number(values: Mapping[str, str], key: str, place: str) -> float:
    """A number of a joint. 0 by default."""
    words = values.get(key, "0").split()
    return number(words[0] if words else "", f"{place}, {key}", "a finite number")


def _efforts(model: Model) -> dict[str, float]:
    """Largest torque [N m] or force [N] of each joint that the file limits."""
    out: dict[str, float] = {}

    def limit(joint: str, ends: Sequence[float], factor: float = 1.0) -> None:
        low, high = (factor * end for end in sorted(ends))
        own = min(-low, high) if low < 0.0 < high else max(abs(low), abs(high))
        out[joint] = min(own, out.get(joint, own))

    for body in model.bodies():
        for part in body.parts_of_kind("joint"):
            name = part.values.get("name", "")
            if model.is_limited(part.values, "actuatorfrc"):
                text = part.values["actuatorfrcrange"]
                limit(name, vector(text, 2, f"joint {name!r}, actuatorfrcrange"))
    for element in model.root.findall("actuator/*"):
        values = model.values(element, MAIN)
        joint = values.get("joint") or values.get("jointinparent")
        if joint is None:
            continue
        place = f"actuator of joint {joint!r}"
        gear = abs(_number(values, "gear", place)) if "gear" in values else 1.0
        if model.is_limited(values, "force"):
            text = values["forcerange"]
            limit(joint, vector(text, 2, f"{place}, forcerange"), gear)
        if element.tag == "motor" and model.is_limited(values, "ctrl"):
            text = values["ctrlrange"]
            limit(joint, vector(text, 2, f"{place}, ctrlrange"), gear)
    return out


def _coupled(model: Model) -> dict[str, str]:
    """Joints that follow other joints by equality constraints, by name."""
    pairs = [
        (element.get("joint1", ""), element.get("joint2"))
        for element in model.root.findall("equality/joint")
    ]
    return {name: other or "a constant" for name, other in pairs}
