"""Subject of a run's camera: contacts, bodies that may hide them, and points that must
be in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Context

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES, Vector3
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Shape
from pushpressslide.sim.convert import planar_pose, transform_from_positions
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.sight import Block, Limb, Moment

MOMENTS = 10  # number of moments at which the contacts are checked
OVER = 1e-3  # [m] over a body, so that it does not hide its own corners
CLEARANCE = 0.012  # [m] distance from object and tip to a contact's marks
LINK_RADIUS = 0.065  # [m] of an arm's links
ROD_RADIUS = 0.015  # [m] of the rod that holds the tip
# [m] distances from the tip at which a force is checked for visibility
ALONG_FORCE = (0.05, 0.1)
WRIST = 0.22  # [m] height above a tip up to which its tool must be visible


@dataclass(frozen=True, eq=False)
class Subject:
    """Subject of a run's camera. Moments are in the support's frame, points in the
    world.
    """

    moments: tuple[Moment, ...]  # along x, y and height of the support
    yaws: tuple[float, ...]  # [rad] of the object at these
    pushes: Array  # (K, 2) directions of the pushes along the support
    near: Array  # (N, 3) [m] in the world: object, goals, tips
    whole: Array  # (M, 3) [m] in the world: also the arms and all bodies


def subject(playback: Playback) -> Subject:
    """Subject of a recorded run."""
    plant = playback.scene.plant
    context = plant.CreateDefaultContext()
    moments = []
    yaws = []
    pushes: list[tuple[float, float]] = []
    near = goal_points(playback)
    whole: list[Vector3] = []
    for tick in sighted_ticks(playback.record.arrays["phase"]):
        playback.set_plant(context, tick)
        contacts = contacts_at(playback, tick)
        X_WB = body_pose(playback, tick)
        yaws.append(X_WB.yaw)
        pushes += [X_WB.rotate(c.normal) for c in contacts if c.kind == "side"]
        limbs = arm_limbs(playback, context)
        moments.append(
            Moment(
                tuple(tips_at(playback, tick, contacts)),
                blocks_at(playback, tick),
                limbs,
                top_corners(playback, tick),
                tuple(_force_points(playback, tick, contacts)),
            )
        )
        near += object_points(playback, tick) + _tip_points(playback, tick, contacts)
        whole += [point for limb in limbs for point in (limb.start, limb.end)]
    frame = playback.task.support.frame
    held = [frame.point(point) for point in near]
    everything = held + [frame.point(point) for point in whole]
    everything += [frame.point(point) for point in other_points(playback)]
    return Subject(
        tuple(moments),
        tuple(yaws),
        np.array(pushes).reshape(-1, 2),
        np.array(held),
        np.array(everything),
    )


def near_points(playback: Playback, tick: int) -> Array:
    """Points (N, 3) [m], in the world, of the object and its contacts at ``tick``."""
    frame = playback.task.support.frame
    contacts = contacts_at(playback, tick)
    points = object_points(playback, tick) + _tip_points(playback, tick, contacts)
    return np.array([frame.point(point) for point in points])


def sighted_ticks(phase: Array) -> NDArray[np.intp]:
    """Ticks at which a contact is checked for visibility. ``phase`` (N,) is that of
    each tick.
    """
    (ticks,) = np.nonzero(np.isin(phase, [PHASES.index("touch"), PHASES.index("move")]))
    if not len(ticks):
        ticks = np.arange(len(phase))
    return ticks[np.linspace(0, len(ticks) - 1, MOMENTS).round().astype(int)]


def contacts_at(playback: Playback, tick: int) -> tuple[Contact, ...]:
    """Contacts of the placement at ``tick``."""
    return placement_at(playback, tick).contacts


def placement_at(playback: Playback, tick: int) -> Plan:
    """Placement at ``tick``, as a separate plan."""
    number = int(playback.record.arrays["placement"][tick])
    return playback.placements[number]


def body_pose(playback: Playback, tick: int) -> Pose2:
    """Pose X_WB at ``tick`` of the object moved by the present placement."""
    return playback.vehicle_pose(tick).compose(
        Pose2(*map(float, playback.record.arrays["vehicle_frame"][tick])).inverse()
    )


def tips_at(
    playback: Playback, tick: int, contacts: tuple[Contact, ...]
) -> list[Vector3]:
    """Positions [m] of the tips in contact."""
    tips = playback.record.arrays["tip_position"][tick]
    places = (map(float, tips[contact.arm]) for contact in contacts)
    return [(x, y, z) for x, y, z in places]


def _force_points(
    playback: Playback, tick: int, contacts: tuple[Contact, ...]
) -> list[Vector3]:
    """Start and end points of the drawn forces [m]."""
    drawn = playback.task.object.shape.height + CLEARANCE
    X_WB = body_pose(playback, tick)
    tips = tips_at(playback, tick, contacts)
    out = []
    for contact, (x, y, z) in zip(contacts, tips, strict=True):
        nx, ny, _ = contact.direction(X_WB)
        top = max(drawn, z)
        out += [(x + far * nx, y + far * ny, top) for far in ALONG_FORCE]
    return out


def blocks_at(playback: Playback, tick: int) -> tuple[Block, ...]:
    """Bodies on the support at ``tick``."""
    task = playback.task
    frame = task.support.frame
    X_WG = planar_pose(playback.object_pose(tick), frame)
    blocks = [_block(task.object.shape, X_WG)]
    for obstacle in task.obstacles:
        pose = obstacle.pose
        row = playback.record.arrays.get(f"body_{obstacle.name}")
        if row is not None:
            pose = planar_pose(transform_from_positions(row[tick]), frame)
        blocks.append(_block(obstacle.shape, pose))
    return tuple(blocks)


def _block(shape: Shape, pose: Pose2) -> Block:
    return Block(tuple(pose.apply(c) for c in shape.outline()), shape.height)


def arm_limbs(playback: Playback, context: Context) -> tuple[Limb, ...]:
    """Links of all arms in the plant's ``context``."""
    count = len(playback.scene.robots)
    return tuple(
        limb for arm in range(count) for limb in limbs_of_arm(playback, context, arm)
    )


def limbs_of_arm(playback: Playback, context: Context, arm: int) -> tuple[Limb, ...]:
    """Links of one arm in the plant's ``context``."""
    plant = playback.scene.plant
    frame = playback.task.support.frame
    robot = playback.scene.robots[arm]
    places = []
    for index in plant.GetBodyIndices(robot.model_instance):
        X = plant.EvalBodyPoseInWorld(context, plant.get_body(index))
        x, y, z = X.translation()
        places.append(frame.coordinates((float(x), float(y), float(z))))
    pairs = list(pairwise(places))
    links = [Limb(start, end, LINK_RADIUS) for start, end in pairs[:-1]]
    rod = [Limb(start, end, ROD_RADIUS) for start, end in pairs[-1:]]
    return (*links, *rod)


def corners(shape: Shape, pose: Pose2) -> list[Vector3]:
    """Corners [m] of a shape on the support, and those of its top."""
    return [
        (*pose.apply(corner), height)
        for corner in shape.outline()[:: max(1, len(shape.outline()) // 12)]
        for height in (0.0, shape.height)
    ]


def goal_points(playback: Playback) -> list[Vector3]:
    """Corners [m] of all goals."""
    return [point for shape, X in playback.goals for point in corners(shape, X)]


def object_points(playback: Playback, tick: int) -> list[Vector3]:
    """Corners [m] of the object at ``tick``."""
    pose = planar_pose(playback.object_pose(tick), playback.task.support.frame)
    return corners(playback.task.object.shape, pose)


def top_corners(playback: Playback, tick: int) -> tuple[Vector3, ...]:
    """Corners [m] of the object's top at ``tick``, and points slightly above it."""
    height = playback.task.object.shape.height
    points = object_points(playback, tick)
    return tuple((x, y, z + OVER) for x, y, z in points if z == height)


def _tip_points(
    playback: Playback, tick: int, contacts: tuple[Contact, ...]
) -> list[Vector3]:
    """End points [m] of the tools in contact."""
    tips = tips_at(playback, tick, contacts)
    return [end for x, y, z in tips for end in ((x, y, z), (x, y, z + WRIST))]


def other_points(playback: Playback) -> list[Vector3]:
    """Corners [m] of all other bodies, at the first and the last tick."""
    last = len(playback.record.arrays["time"]) - 1
    blocks = blocks_at(playback, 0)[1:] + blocks_at(playback, last)[1:]
    return [
        (*corner, height)
        for block in blocks
        for corner in block.outline
        for height in (0.0, block.height)
    ]
