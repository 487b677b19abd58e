"""Facts about any serial robot, read from its URDF, SDF or MJCF file: the chain from
the root link to the tip frame, and the links fixed to this chain.

Joints off the chain are held at zero. SDF is supported in its common form: one model,
link poses in the model's frame, and joints at their child links. Convert other SDF
files to URDF.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from pushpressslide.core.errors import (
    MissingFrameError,
    PushPressSlideError,
    RobotFileError,
    Shown,
)
from pushpressslide.core.scene import MODELS, PATHS, is_robot_file
from pushpressslide.robots.facts import (
    JointFacts,
    LinkFacts,
    RobotFacts,
    rotation_from_rpy,
)
from pushpressslide.robots.file_data import KINDS, Description, physical, rpy_of
from pushpressslide.robots.file_tree import (
    WORLD,
    check_masses,
    check_moving,
    check_tree,
)
from pushpressslide.robots.file_values import UnfitValue
from pushpressslide.robots.mjcf_file import read_mjcf
from pushpressslide.robots.sdf_file import read_sdf
from pushpressslide.robots.urdf_file import read_urdf
from pushpressslide.robots.xml_root import xml_root

READERS = {"robot": read_urdf, "sdf": read_sdf, "mujoco": read_mjcf}
"""Readers of robot files, by the root element of a file."""
MISSING_TIP_FRAME = (
    "a model given by path needs tip, the tip's place on a link, or tip_frame, the "
    "name of the frame at the tip's centre"
)
BESIDE_ARM = r"(?i)finger|gripper|jaw|knuckle|hand_|camera|leg|wheel"
"""Pattern of names of links that are not at the end of an arm."""
GROUND = "pps_ground"
"""Name of the base link of a robot whose first joints move its stand in the world."""
MOST_NOTES = 4  # largest number of notes of one kind


def read_description(
    model: str, tip_frame: str | None, packages: Sequence[str] = ()
) -> RobotFacts:
    """Facts about the robot in a URDF, SDF or MJCF file, with ``tip_frame`` as its
    flange and its tip. ``packages`` are folders with packages of meshes.

    Raises PushPressSlideError, in one line, if the file is missing, or if the tip frame
    is missing or not named. Raises RobotFileError, with link or joint, for values that
    no arm can have.
    """
    path = Path(model)
    if not is_robot_file(path):
        raise PushPressSlideError(f"choose {', '.join(MODELS)}, or {PATHS}")
    if not path.is_file():
        raise PushPressSlideError("there is no such file")
    if tip_frame is None:
        raise PushPressSlideError(MISSING_TIP_FRAME)
    with _blaming(model):
        return _facts(path, tip_frame, packages)


def last_link(model: str) -> str:
    """Link at the end of the longest chain of moving joints in a robot's file. Fixed
    links that follow the chain belong to it.

    Raises the errors of ``read_description``.
    """
    path = Path(model)
    if not is_robot_file(path) or not path.is_file():
        read_description(model, "")  # raises an error that names the fault
    with _blaming(model):
        whole = read_content(path, ())
    by_child = {joint.child: joint for joint in whole.joints}

    def depth(link: str) -> tuple[int, int]:
        """Number of revolute joints, and number of all joints, from the root to a link."""
        turning = count = 0
        while link in by_child:
            joint = by_child[link]
            turning += joint.kind == "revolute"
            count += 1
            link = joint.parent
        return turning, count

    names = [link.name for link in whole.links if not re.search(BESIDE_ARM, link.name)]
    return max(names or [link.name for link in whole.links], key=depth)


def read_content(path: Path, packages: Sequence[str]) -> Description:
    """Content of an existing file. Its links and joints are checked to form one tree."""
    root = xml_root(path)
    if root.tag not in READERS:
        allowed = ", ".join(READERS)
        raise PushPressSlideError(f"its root is <{root.tag}>; allowed: {allowed}")
    content = READERS[root.tag](root, path, packages)
    if not content.links:
        raise PushPressSlideError("it has no link")
    check_tree([link.name for link in content.links], content.joints)
    return content


def _facts(path: Path, tip_frame: str, packages: Sequence[str]) -> RobotFacts:
    """Checked facts of an existing file."""
    description = _without_world(read_content(path, packages))
    chain = _chain(description, tip_frame)
    base = chain[0].parent if chain else tip_frame
    moving = [joint for joint in chain if joint.kind != "fixed"]
    if not moving:
        raise PushPressSlideError(
            f"no joint moves between its root {base!r} and the tip frame {tip_frame!r}"
        )
    _check_driven(chain, description.odd)
    check_moving(moving, description.mimics)
    masses = {link.name: link.mass for link in description.links}
    check_masses(moving, description.joints, masses)
    branches, held = _branches(description, chain, base)
    names = {base, *(joint.child for joint in (*chain, *branches))}
    read_links = [link for link in description.links if link.name in names]
    links = [physical(link) for link in read_links]
    odd = [a.name for a, b in zip(links, read_links, strict=True) if a != b]
    notes = [
        *_named("held where it is: joint", held),
        *_named("no body has such an inertia; replaced by the nearest one: link", odd),
        *description.notes,
    ]
    return RobotFacts(
        description.name or path.stem,
        (*links, *_frames(chain)),
        tuple(chain),
        base,
        tip_frame,
        tuple(0.5 * (joint.lower + joint.upper) for joint in moving),
        branches=branches,
        shapes=tuple(shape for shape in description.shapes if shape.link in names),
        notes=tuple(notes),
        home_first=True,
    )


def _frames(chain: Sequence[JointFacts]) -> Iterator[LinkFacts]:
    """Yield a massless link if the tip is a frame on another link."""
    if chain[-1].name == f"{chain[-1].child}_mount":
        yield LinkFacts(chain[-1].child)


def _named(what: str, names: Sequence[str]) -> list[str]:
    """A note that lists some names, if there are any."""
    if not names:
        return []
    more = f" and {len(names) - MOST_NOTES} more" if len(names) > MOST_NOTES else ""
    return [f"{what} {', '.join(names[:MOST_NOTES])}{more}"]


def _without_world(whole: Description) -> Description:
    """The description without a link ``world`` that only holds the base.

    If ``world`` carries a moving joint, it is itself the base, and is renamed.
    """
    on_world = [joint for joint in whole.joints if joint.parent == WORLD]
    if not on_world:
        return whole
    if any(joint.kind != "fixed" for joint in on_world):
        links = [link for link in whole.links if link.name != WORLD]
        return replace(
            whole,
            links=[LinkFacts(GROUND), *links],
            joints=[
                replace(joint, parent=GROUND) if joint.parent == WORLD else joint
                for joint in whole.joints
            ],
        )
    names = ", ".join(joint.name for joint in on_world)
    note = f"left out: link 'world' and joint {names}; the task says where the base is"
    return replace(
        whole,
        links=[link for link in whole.links if link.name != WORLD],
        joints=[joint for joint in whole.joints if joint.parent != WORLD],
        notes=[note, *whole.notes],
    )


def _check_driven(chain: Sequence[JointFacts], odd: Mapping[str, str]) -> None:
    """Raise UnfitValue for a joint on the chain that cannot be driven."""
    for joint in chain:
        if joint.name in odd:
            allowed = f"{', '.join(KINDS)} on the way to the tip"
            place = f"joint {joint.name!r}, type"
            raise UnfitValue(place, Shown(repr(odd[joint.name])), allowed)


def _branches(
    description: Description, chain: Sequence[JointFacts], base: str
) -> tuple[tuple[JointFacts, ...], list[str]]:
    """Joints to the links off the chain, all made fixed, and the names of the joints
    that are not fixed in the file.
    """
    below: dict[str, list[JointFacts]] = {}
    for joint in description.joints:
        below.setdefault(joint.parent, []).append(joint)
    own = {joint.name for joint in chain}
    out = []
    held = []
    links = [base, *(joint.child for joint in chain)]
    while links:
        for joint in below.get(links.pop(), ()):
            if joint.name in own:
                continue
            if joint.kind != "fixed" or joint.name in description.odd:
                held.append(joint.name)
            out.append(_fixed_at_zero(joint))
            links.append(joint.child)
    return tuple(out), held


def _fixed_at_zero(joint: JointFacts) -> JointFacts:
    """A joint that is fixed at zero, or at its limit next to zero."""
    value = min(max(0.0, joint.lower), joint.upper)
    R = rotation_from_rpy(joint.rpy)
    xyz = joint.xyz
    rpy = joint.rpy
    axis = np.array(joint.axis)
    if joint.kind == "prismatic":
        x, y, z = (np.array(joint.xyz) + R @ axis * value).tolist()
        xyz = (x, y, z)
    elif joint.kind == "revolute" and value != 0.0:
        rpy = rpy_of(R @ _turned(axis, value))
    return JointFacts(joint.name, "fixed", joint.parent, joint.child, xyz, rpy)


def _turned(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation (3, 3) by an ``angle`` [rad] about a unit axis (3,)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    out: np.ndarray = np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K
    return out


@contextmanager
def _blaming(model: str) -> Iterator[None]:
    """Attribute errors inside the block to a model's file."""
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


def _chain(description: Description, tip_frame: str) -> list[JointFacts]:
    """Joints from the root link to the tip frame."""
    chain: list[JointFacts] = []
    link = tip_frame
    links = [one.name for one in description.links]
    for frame in description.frames:
        if frame.name == tip_frame:
            mount = f"{tip_frame}_mount"
            chain.append(
                JointFacts(
                    mount, "fixed", frame.parent, tip_frame, frame.xyz, frame.rpy
                )
            )
            link = frame.parent
    if link not in links:
        names = [*links, *(frame.name for frame in description.frames)]
        known = ", ".join(names)
        raise MissingFrameError(
            f"it has no frame {tip_frame!r}; there are {known[:300]}"
        )
    by_child = {joint.child: joint for joint in description.joints}
    while link in by_child:
        joint = by_child[link]
        chain.append(joint)
        link = joint.parent
    chain.reverse()
    return chain
