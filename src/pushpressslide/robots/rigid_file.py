"""An object in a URDF, SDF or MJCF file, as one rigid body with all joints at zero."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.description import read_content
from pushpressslide.robots.facts import JointFacts, LinkShape, rotation_from_rpy
from pushpressslide.robots.file_data import Description
from pushpressslide.robots.file_tree import check_tree
from pushpressslide.robots.xml_root import xml_root

FRICTIONS = ("mu", "mu1", "drake_mu_dynamic")
"""Elements of URDF and SDF that specify the friction of a surface."""


@dataclass(frozen=True)
class RigidObject:
    """The parts of an object, in the frame of its file."""

    shapes: tuple[tuple[LinkShape, Array], ...]  # with their poses (4, 4) [m]
    mass: float  # [kg]; 0 if the file has none
    center: Array  # (3,) [m] of mass
    frictions: tuple[float, ...]  # of its surfaces, each once


def read_rigid_object(path: Path) -> RigidObject:
    """Object in a file.

    Raises PushPressSlideError, in one line, for a file that cannot be read or contains
    no shape.
    """
    content = read_content(path, ())
    check_tree([link.name for link in content.links], content.joints)
    poses = _link_poses(content)
    solid = [s for s in content.shapes if s.solid] or content.shapes
    shapes = tuple(
        (shape, poses[shape.link] @ _pose(shape.xyz, shape.rpy)) for shape in solid
    )
    masses = np.array([link.mass for link in content.links])
    centers = np.array(
        [(poses[link.name] @ (*link.com, 1.0))[:3] for link in content.links]
    )
    mass = float(masses.sum())
    center = masses @ centers / mass if mass > 0.0 else np.zeros(3)
    return RigidObject(shapes, mass, center, tuple(sorted(set(_frictions(path)))))


def _link_poses(content: Description) -> dict[str, Array]:
    """Pose (4, 4) of each link with all joints at zero."""
    by_child = {joint.child: joint for joint in content.joints}
    poses: dict[str, Array] = {}
    for link in content.links:
        poses[link.name] = np.eye(4)
        for joint in _path_to_root(link.name, by_child):
            poses[link.name] = _pose(joint.xyz, joint.rpy) @ poses[link.name]
    return poses


def _path_to_root(link: str, by_child: dict[str, JointFacts]) -> Iterator[JointFacts]:
    while link in by_child:
        yield by_child[link]
        link = by_child[link].parent


def _pose(xyz: Sequence[float], rpy: tuple[float, float, float]) -> Array:
    X = np.eye(4)
    X[:3, :3] = rotation_from_rpy(rpy)
    X[:3, 3] = xyz
    return X


def _frictions(path: Path) -> Iterator[float]:
    """Frictions of surfaces specified in a file."""
    for element in xml_root(path).iter():
        text = element.get("friction") if element.tag == "geom" else None
        if element.tag in FRICTIONS:
            text = element.text or element.get("value")
        try:
            yield float((text or "").split()[0])
        except (IndexError, ValueError):
            continue
