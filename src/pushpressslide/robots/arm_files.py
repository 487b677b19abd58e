"""Facts about a task's robot, from the package or from a file, completed by the task's
tip, ready posture and rotors.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import RobotFileError
from pushpressslide.core.scene import MODELS, JointLimits
from pushpressslide.core.task import Robot
from pushpressslide.robots.description import read_description
from pushpressslide.robots.facts import (
    TIP,
    JointFacts,
    LinkFacts,
    RobotFacts,
    load_facts,
)
from pushpressslide.robots.kinematics import ArmKinematics

TIP_LINK = "pps_tip_foot"
"""Link that carries the rod of a ``tip``."""
ROTOR = 0.003
"""Rotor inertia per effort [kg m^2 / (N m)] of a joint whose file has no rotor."""
ROTOR_WITHOUT_LIMIT = 0.1
"""Rotor inertia [kg m^2] of a joint whose file states no effort."""
ROTOR_OF_SLIDE = 5.0
"""Rotor inertia [kg] of a sliding joint whose file states no effort."""
MOTOR_FIELDS = {
    "gear_ratio": "gear_ratio",
    "rotor_inertia": "rotor_inertia",
    "joint_friction": "damping",
}
"""Facts about a joint, by their field in the task."""


def robot_facts(robot: Robot) -> RobotFacts:
    """Facts about a task's robot.

    Raises PushPressSlideError for a model that is neither in the package nor a readable
    file, and RobotFileError for a list in the task that does not fit the joints of the
    file.
    """
    if robot.model in MODELS:
        return load_facts(robot.model)
    return _completed(at_origin(robot), changed_at(robot))


@lru_cache(maxsize=64)
def at_origin(robot: Robot) -> Robot:
    """The same robot with its base at the origin."""
    return replace(robot, base=(0.0, 0.0, 0.0), base_yaw=0.0)


def changed_at(robot: Robot) -> int:
    """Time [ns] of the last change of a robot's file. 0 without a file."""
    if robot.model in MODELS:
        return 0
    try:
        return Path(robot.model).stat().st_mtime_ns
    except OSError:
        return 0  # the reader says what is wrong


def arm_kinematics(robot: Robot) -> ArmKinematics:
    """Kinematics of a task's robot.

    Raises the errors of ``robot_facts``.
    """
    return _kinematics(robot, changed_at(robot))


@lru_cache(maxsize=32)
def _kinematics(robot: Robot, changed: int) -> ArmKinematics:
    """Kinematics of a robot, cached until its file changes."""
    facts = robot_facts(robot)
    length = rod_length(robot)
    return ArmKinematics(facts, robot.base, robot.base_yaw, length, robot.tip_radius)


def rod_length(robot: Robot) -> float:
    """Length [m] of the rod between flange and tip. For a file with a tip frame, the
    rod is part of the file.
    """
    return robot.tip_length if mounts_tip(robot) else 0.0


def mounts_tip(robot: Robot) -> bool:
    """Whether rod and tip are added to a robot. A file with a tip frame contains them."""
    return robot.model in MODELS or robot.tip is not None


@lru_cache(maxsize=32)
def _completed(robot: Robot, changed: int) -> RobotFacts:
    """Facts from a file, cached until the file changes."""
    tip = robot.tip
    frame = robot.tip_frame if tip is None else tip.link
    facts = read_description(robot.model, frame, robot.packages)
    if tip is not None:
        mount = JointFacts(
            f"{TIP_LINK}_mount", "fixed", facts.flange, TIP_LINK, tip.xyz, tip.rpy
        )
        facts = replace(
            facts,
            joints=(*facts.joints, mount),
            links=(*facts.links, LinkFacts(TIP_LINK)),
            flange=TIP_LINK,
        )
    facts = _with_motors(_with_limits(facts, robot), robot)
    return _with_home(facts, robot)


def _fitting(
    values: tuple[float, ...], facts: RobotFacts, robot: Robot, name: str
) -> tuple[float, ...]:
    """Values of a field. Raises RobotFileError unless there is one value per joint."""
    if len(values) != facts.size:
        joints = ", ".join(joint.name for joint in facts.moving)
        allowed = f"allowed: {facts.size} numbers, one for each of {joints}"
        raise RobotFileError(robot.model, f"robots[].{name}", list(values), allowed)
    return values


def _with_limits(facts: RobotFacts, robot: Robot) -> RobotFacts:
    """Facts with the task's limits in place of the file's."""
    limits = {limit.joint: limit for limit in robot.limits or ()}
    names = [joint.name for joint in facts.moving]
    for name in limits:
        if name not in names:
            allowed = f"allowed: a joint on the way to the tip: {', '.join(names)}"
            raise RobotFileError(robot.model, "robots[].limits[].joint", name, allowed)
    joints = tuple(
        _limited(joint, limits[joint.name], robot) if joint.name in limits else joint
        for joint in facts.joints
    )
    return replace(facts, joints=joints)


def _limited(joint: JointFacts, limit: JointLimits, robot: Robot) -> JointFacts:
    """A joint with the task's limits. For a slide they are in metres, not in degrees."""
    unit = math.degrees(1.0) if joint.kind == "prismatic" else 1.0
    low, high = limit.position or (joint.lower / unit, joint.upper / unit)
    if low >= high:
        field = "robots[].limits[].position_deg"
        value = [round(math.degrees(end), 6) for end in (low, high)]
        raise RobotFileError(robot.model, field, value, "allowed: lower < upper")
    speed = joint.velocity if limit.speed is None else unit * limit.speed
    torque = joint.effort if limit.torque is None else limit.torque
    return replace(
        joint, lower=unit * low, upper=unit * high, velocity=speed, effort=torque
    )


def _with_motors(facts: RobotFacts, robot: Robot) -> RobotFacts:
    """Facts with the task's rotors, gear ratios and friction in place of those in the
    file. Joints without a rotor get an assumed one.
    """
    changes: list[dict[str, Any]] = [{} for _ in facts.moving]
    if robot.rotor_inertia is not None:
        changes = [{"gear_ratio": 1.0} for _ in facts.moving]
    for name, key in MOTOR_FIELDS.items():
        values = getattr(robot, name)
        if values is not None:
            given = _fitting(values, facts, robot, name)
            changes = [c | {key: v} for c, v in zip(changes, given, strict=True)]
    changed = dict(zip((joint.name for joint in facts.moving), changes, strict=True))
    joints = tuple(
        replace(joint, **changed.get(joint.name, {})) for joint in facts.joints
    )
    facts = replace(facts, joints=joints)
    without = [joint.name for joint in facts.moving if joint.rotor_inertia == 0.0]
    if not without or robot.rotor_inertia is not None:
        return facts
    joints = tuple(
        replace(joint, gear_ratio=1.0, rotor_inertia=_assumed_rotor(joint))
        if joint.name in without
        else joint
        for joint in facts.joints
    )
    note = (
        f"assumed: rotors of {ROTOR:g} kg m^2 for each N m of effort, as the file has "
        "none (rotor_inertia)"
    )
    return replace(facts, joints=joints, notes=(*facts.notes, note))


def _assumed_rotor(joint: JointFacts) -> float:
    """Rotor inertia [kg m^2; kg] assumed for a joint whose file has none."""
    if joint.kind == "prismatic":
        return ROTOR_OF_SLIDE
    if math.isinf(joint.effort):
        return ROTOR_WITHOUT_LIMIT
    return ROTOR * joint.effort


def _with_home(facts: RobotFacts, robot: Robot) -> RobotFacts:
    """Facts with a ready posture: that of the task, or one found by a search."""
    if robot.home is not None:
        home = _fitting(robot.home, facts, robot, "home_deg")
        for joint, angle in zip(facts.moving, home, strict=True):
            if not joint.lower <= angle <= joint.upper:
                low, high = math.degrees(joint.lower), math.degrees(joint.upper)
                allowed = (
                    f"allowed: in [{low:.4g}, {high:.4g}] for joint {joint.name!r}"
                )
                value = round(math.degrees(angle), 6)
                raise RobotFileError(robot.model, "robots[].home_deg", value, allowed)
        return replace(facts, home_posture=home)
    found = ready_posture(facts, rod_length(robot))
    return replace(facts, home_posture=tuple(found.tolist()))


DRAWS = 4000
"""Number of random postures used to measure an arm's reach."""
DOWNWARD = 200
"""Number of random postures that are kept: those with the tool closest to straight
down.
"""
SEEDS = 24
"""Number of kept postures from which a search starts: the least twisted ones."""
HEIGHTS = (0.15, 0.3, 0.45)
DISTANCES = (0.35, 0.45)
"""Distances of the tip from the base at which the ready posture is sought, as shares of
the reach.
"""
GROUPS = 8
"""Number of searches from different starts. Each takes the posture with the largest
margin.
"""
GOOD = 0.6
"""Smallest conditioning of an acceptable posture, as a share of that of the best
posture. The least twisted acceptable posture is taken.
"""
ENOUGH_MARGIN = 0.5
"""Joint margin [rad] above which a larger one no longer counts."""


def ready_posture(facts: RobotFacts, length: float) -> Array:
    """Ready posture (n,): the tool points down over the workspace in front of the base.

    The posture is well conditioned, far from the joint limits, and the least twisted of
    such postures. An arm that cannot point its tool down gets the random posture that
    comes nearest to it. ``length`` [m] is that of the rod.
    """
    from pushpressslide.robots.inverse import solve_ik

    rng = np.random.default_rng(0)
    low = np.maximum(facts.lower, -math.pi)
    high = np.minimum(facts.upper, math.pi)
    q = low + (high - low) * rng.random((DRAWS, facts.size))
    kin = ArmKinematics(replace(facts, home_posture=tuple(q[0])), tip_length=length)
    R, p = kin.tip_pose(q)
    reach = float(np.quantile(np.linalg.norm(p, axis=1), 0.98))
    places = [(d * reach, 0.0, h * reach) for d in DISTANCES for h in HEIGHTS]
    downward = -R[:, 2, 2]
    down = q[np.argsort(-downward)[:DOWNWARD]]
    seeds = down[np.argsort(_sideways(kin, down))[:SEEDS]]
    if facts.moving[0].kind == "revolute":
        bearing = np.arctan2(*kin.tip_pose(seeds)[1][:, 1::-1].T)
        ahead = seeds[:, 0] - (kin.turning or 1.0) * bearing
        seeds[:, 0] = np.clip(ahead, low[0], high[0])
    found = [
        solve_ik(kin, np.array(places), q_seed=group)
        for group in np.array_split(seeds, GROUPS)
    ]
    postures = np.concatenate([one.q[one.converged] for one in found])
    if not len(postures):
        out: Array = q[int(np.argmax(downward))]
        return out
    upright = _links_above(kin, postures)
    if upright.any():
        postures = postures[upright]
    margin = np.minimum(kin.joint_margin(postures), ENOUGH_MARGIN)
    J = kin.jacobian(postures)
    J[:, 3:] /= reach
    size = np.linalg.svd(J, compute_uv=False)[:, -1]
    good = margin * size
    sideways = np.where(good >= GOOD * good.max(), _sideways(kin, postures), math.inf)
    best: Array = postures[int(np.argmin(sideways))]
    return best


def _sideways(kin: ArmKinematics, q: Array) -> Array:
    """Mean distances (m,) [m] of the links from the vertical plane through base and
    tip, in postures (m, n).

    They are small if a redundant arm is not twisted.
    """
    poses = kin.link_poses(q)
    x, y = poses[TIP][1][..., 0], poses[TIP][1][..., 1]
    across = np.stack([-y, x], axis=-1) / np.hypot(x, y)[..., None]
    links = [poses[joint.child][1][..., :2] for joint in kin.facts.moving[1:]]
    out: Array = np.mean([abs((p * across).sum(axis=-1)) for p in links], axis=0)
    return out


def _links_above(kin: ArmKinematics, q: Array) -> NDArray[np.bool_]:
    """Mask of the postures (m, n) in which all links, from the third joint on, are
    above the tip.
    """
    poses = kin.link_poses(q)
    links = [joint.child for joint in kin.facts.moving[2:]]
    heights = np.array([poses[link][1][..., 2] for link in links])
    out: NDArray[np.bool_] = np.all(heights > poses[TIP][1][..., 2], axis=0)
    return out
