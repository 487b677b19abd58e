"""An MJCF file with its includes, default classes and frames resolved: bodies and their
parts, each with its pose.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.robots.file_values import FARTHEST, UnfitValue, vector
from pushpressslide.robots.mesh_paths import MeshPaths
from pushpressslide.robots.xml_root import xml_root

UNREAD = ("attach", "replicate", "composite", "flexcomp")
MAIN = "main"
Classes = Mapping[str, Mapping[str, Mapping[str, str]]]
Pose = tuple[Array, Array]  # (3, 3) and (3,) [m]


@dataclass(frozen=True)
class Part:
    """An element of a body: body, joint, geom, site or inertial."""

    element: Element
    values: Mapping[str, str]  # with the defaults of its class
    X: Pose  # in the body's frame
    childclass: str

    @property
    def place(self) -> str:
        """Description of the element, for messages."""
        return f"{self.element.tag} {self.values.get('name', '')!r}"


@dataclass(frozen=True)
class Body:
    """A body with its parts, except other bodies."""

    name: str
    parent: str  # empty for the world
    X: Pose  # in its parent's frame
    parts: tuple[Part, ...]

    def parts_of_kind(self, *tags: str) -> list[Part]:
        """The parts with one of the given tags."""
        return [part for part in self.parts if part.element.tag in tags]


@dataclass(frozen=True)
class Model:
    """Elements of an MJCF file, and the settings of its compiler."""

    root: Element
    compiler: Mapping[str, str]
    classes: Classes

    @classmethod
    def from_file(cls, root: Element, paths: MeshPaths) -> Model:
        """Model of a file with the given ``root``. Included files are next to this
        file.

        Raises PushPressSlideError for elements that are not supported.
        """
        _include(root, paths, [])
        compiler: dict[str, str] = {}
        for element in root.findall("compiler"):
            compiler |= element.attrib
        classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
        for element in root.findall("default"):
            _add_class(classes, element, classes[MAIN], element.get("class", MAIN))
        return cls(root, compiler, classes)

    def values(self, element: Element, childclass: str) -> dict[str, str]:
        """Attributes of an element, completed by those of its class.

        Raises UnfitValue for a missing class.
        """
        name = element.get("class") or childclass
        if name not in self.classes:
            known = ", ".join(self.classes)
            raise UnfitValue(f"{element.tag}, class", name, f"one of {known}")
        return {**self.classes[name].get(element.tag, {}), **element.attrib}

    def angle(self, value: float) -> float:
        """An angle of the file, converted to [rad]."""
        degrees = self.compiler.get("angle", "degree") == "degree"
        return float(np.radians(value)) if degrees else value

    def is_limited(self, values: Mapping[str, str], key: str = "") -> bool:
        """Whether the range of a joint or an actuator applies."""
        limited = values.get(f"{key}limited", "auto")
        automatic = self.compiler.get("autolimits", "true") == "true"
        given = f"{key}range" in values
        return given and (limited == "true" or (limited == "auto" and automatic))

    def pose(self, values: Mapping[str, str], place: str) -> Pose:
        """Pose from ``pos`` and one of the five forms of an orientation."""
        p = vector(values.get("pos"), 3, f"{place}, pos", (0.0,) * 3, FARTHEST)
        return self.rotation(values, place), np.array(p)

    def rotation(self, values: Mapping[str, str], place: str) -> Array:
        """Rotation (3, 3) from one of the five forms of an orientation."""

        def numbers(key: str, count: int) -> Array:
            return np.array(vector(values[key], count, f"{place}, {key}"))

        out: Array = np.eye(3)
        if "quat" in values:
            w, x, y, z = numbers("quat", 4)
            out = Rotation.from_quat([x, y, z, w]).as_matrix()
        elif "axisangle" in values:
            *axis, angle = numbers("axisangle", 4)
            turn = self.angle(angle) / np.linalg.norm(axis)
            out = Rotation.from_rotvec(np.array(axis) * turn).as_matrix()
        elif "euler" in values:
            order = self.compiler.get("eulerseq", "xyz")
            for letter, angle in zip(order, numbers("euler", 3), strict=True):
                turn = Rotation.from_euler(letter.lower(), self.angle(float(angle)))
                R = turn.as_matrix()
                # a small letter turns about the body's axis, a capital about the parent's
                out = out @ R if letter.islower() else R @ out
        elif "xyaxes" in values:
            axes = numbers("xyaxes", 6)
            x, y = axes[:3], axes[3:]
            z = np.cross(x, y)
            columns = [x, np.cross(z, x), z]
            out = np.stack([c / np.linalg.norm(c) for c in columns], axis=1)
        elif "zaxis" in values:
            out = rotation_to(numbers("zaxis", 3))
        return out

    def bodies(self) -> list[Body]:
        """All bodies, parents first."""
        world = self.root.findall("worldbody")
        out: list[Body] = []
        for one in world:
            for part in self._parts(one, MAIN, (np.eye(3), np.zeros(3))):
                if part.element.tag == "body":
                    self._add_body(out, part, "")
        return out

    def _add_body(self, bodies: list[Body], part: Part, parent: str) -> None:
        """Add a body and all bodies below it."""
        name = part.values.get("name") or f"body_{len(bodies)}"
        inner = part.element.get("childclass") or part.childclass
        parts = tuple(self._parts(part.element, inner, (np.eye(3), np.zeros(3))))
        own = tuple(one for one in parts if one.element.tag != "body")
        bodies.append(Body(name, parent, part.X, own))
        for one in parts:
            if one.element.tag == "body":
                self._add_body(bodies, one, name)

    def _parts(self, holder: Element, childclass: str, X: Pose) -> Iterator[Part]:
        """Yield the elements of a body, or of a frame at the pose ``X`` in the body."""
        for element in holder:
            if element.tag in UNREAD:
                raise PushPressSlideError(
                    f"it has <{element.tag}>; save it from MuJoCo as one plain model"
                )
            values = self.values(element, childclass)
            place = f"{element.tag} {values.get('name', '')!r}"
            R, p = X
            if element.tag == "joint":
                pose = X
            else:
                R_own, p_own = self.pose(values, place)
                pose = (R @ R_own, p + R @ p_own)
            if element.tag == "frame":
                inner = element.get("childclass") or childclass
                yield from self._parts(element, inner, pose)
            else:
                yield Part(element, values, pose, childclass)


def rotation_to(direction: Array) -> Array:
    """Smallest rotation (3, 3) that turns the z axis to a direction (3,)."""
    unit = direction / np.linalg.norm(direction)
    axis = np.cross([0.0, 0.0, 1.0], unit)
    size = float(np.linalg.norm(axis))
    if size < 1e-12:
        axis = np.array([1.0, 0.0, 0.0])
        size = 1.0
    turn = np.arctan2(np.linalg.norm(np.cross([0.0, 0.0, 1.0], unit)), unit[2])
    out: Array = Rotation.from_rotvec(axis / size * turn).as_matrix()
    return out


def _include(holder: Element, paths: MeshPaths, files: list[Path]) -> None:
    """Replace every ``include`` below an element by the content of its file."""
    for i, element in reversed(list(enumerate(holder))):
        if element.tag != "include":
            _include(element, paths, files)
            continue
        name = element.get("file", "")
        path = paths.find(name)
        if path is None or path in files:
            reason = "a file near this one, included once"
            raise UnfitValue("include, file", name, reason)
        inner = xml_root(path)
        _include(inner, paths, [*files, path])
        holder[i : i + 1] = list(inner)


def _add_class(
    classes: dict[str, dict[str, dict[str, str]]],
    element: Element,
    parent: Mapping[str, Mapping[str, str]],
    name: str,
) -> None:
    """Add a class of defaults, and the classes inside it."""
    own = {tag: dict(values) for tag, values in parent.items()}
    for child in element:
        if child.tag != "default":
            own[child.tag] = own.get(child.tag, {}) | child.attrib
    classes[name] = own
    for child in element.findall("default"):
        _add_class(classes, child, own, child.attrib["class"])
