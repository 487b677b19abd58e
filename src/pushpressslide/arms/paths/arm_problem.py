"""Problem of one arm in a plan: bring the tip to its contact, and keep it there along
the path.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from pushpressslide.arms.model import ArmModel
from pushpressslide.arms.paths.approach import Approach
from pushpressslide.arms.paths.clearance import Clearance, Gap
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.arms.paths.postures import POSE, TipPath, ToolOption, tool_options
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Robot
from pushpressslide.planning.carried import carried_ways
from pushpressslide.planning.side_contacts import before_contacts
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.contact_reach import TURNING, tool_azimuths
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude

STEP = 0.015  # [m] of the object's path between samples
TURN_ARM = 0.2  # [m] of path that a turn by one radian counts as
LEAVING = 1e-3  # [m] by which an arm that stands too near may come nearer as it leaves
# [m] of the links from an object that may not be where it is believed to be
OBJECT_ROOM = 0.015
JOINT_ROOM = 0.05  # [rad; m of slides] the same of the joints from their limits
# condition number of the Jacobian beyond which 2 N m of joint friction move the tip with
# more force than the servo of its height may use
CONDITION_ROOM = 25.0
GLANCE = 4  # every fourth posture along a contact is checked before all of them are


@dataclass(frozen=True)
class ObjectPath:
    """The object's planned path over all segments of one placement, as k samples."""

    arc_length: Array  # (k,) [m]
    bodies: list[Pose2]  # X_WB
    shapes: list[Pose2]  # X_WG


@dataclass(frozen=True)
class ContactPath:
    """A contact that moves with the object, and its tip path."""

    contact: Contact
    tip: TipPath
    normal: Vector3  # world; from the tip into the object, at the start


@dataclass(frozen=True, eq=False)
class ArmProblem:
    """One arm of a plan, with its initial posture.

    Derived parts (kinematics, planning plant, approach) are built on first use.
    """

    library: ArmLibrary
    plan: Plan
    arm: int
    start: Array | None = None  # (n,) [rad]; None: the ready posture
    holds: bool = False  # the arm has its contact at the start, and keeps it
    # postures (n,) of the arms that stand still, by index
    others: Mapping[int, Array] = field(default_factory=dict)

    @cached_property
    def query(self) -> MotionQuery:
        """Motion query of the plan."""
        return self.plan.query

    @property
    def robot(self) -> Robot:
        """The arm as the task describes it."""
        return self.query.scene.robots[self.arm]

    @cached_property
    def kin(self) -> ArmKinematics:
        """The arm's kinematics."""
        return arm_kinematics(self.robot)

    @cached_property
    def dynamics(self) -> ArmModel:
        """The arm's dynamics, for the torque that holds a contact."""
        return self.library.model(self.robot)

    @cached_property
    def clearance(self) -> Clearance:
        """Clearance model of the arm."""
        return self.library.clearance(self.plan, self.arm, self.others)

    @cached_property
    def object_path(self) -> ObjectPath:
        """The object's sampled path."""
        return object_path(self.plan)

    @cached_property
    def along(self) -> ContactPath | None:
        """The arm's contact along the object's path. None for an arm that waits."""
        contact = next((c for c in self.plan.contacts if c.arm == self.arm), None)
        if contact is None:
            return None
        path = self.object_path
        inside, height = contact.tip_place(self.robot.tip_radius)
        frame = self.query.scene.support.frame
        positions = [frame.point((*X.apply(inside), height)) for X in path.bodies]
        yaws = np.unwrap(np.array([X.yaw for X in path.bodies]))
        tip = TipPath(np.array(positions), yaws, path.shapes)
        normal = frame.direction(contact.direction(path.bodies[0]))
        return ContactPath(contact, tip, normal)

    def margin_share(
        self, to_object: float, joint_margin: float = math.inf, condition: float = 1.0
    ) -> float:
        """Share of what an unsure object asks for, at most 1.

        ``to_object`` [m] is the links' smallest distance from it, ``condition`` the
        largest condition number of the Jacobian: at a singularity the share is a half,
        since links that meet the object are worse. Among paths with less than 1, the
        one with the most is preferred.
        """
        if not self.query.scene.planned_for_errors:
            return 1.0
        return min(
            1.0,
            to_object / OBJECT_ROOM,
            joint_margin / JOINT_ROOM,
            0.5 + 0.5 * CONDITION_ROOM / condition,
        )

    @property
    def posture(self) -> Array:
        """Initial posture (n,) [rad] of the arm."""
        return self.kin.facts.home if self.start is None else self.start

    @cached_property
    def approach(self) -> Approach:
        """Approaches from the initial posture."""
        query = self.query
        return Approach(
            query.scene,
            self.kin,
            lambda q: self.free(self.clearance, q),
            before_contacts(query.scene, query.motion, self.plan.contacts),
            self.start,
        )

    def tool_options(self, along: ContactPath) -> list[ToolOption]:
        """Tool attitudes to try along a contact, the preferred option first.

        The tool of an arm with fewer than six joints stays upright.
        """
        contact = along.contact
        axes = self.query.scene.support.frame.axes
        bodies = self.object_path.bodies
        middle = len(bodies) // 2
        base = self.query.scene.bases[self.arm]
        azimuths = tool_azimuths(contact, bodies[middle], base)
        if self.kin.facts.size < POSE:
            return [(ToolAttitude(0.0, azimuths[0], axes), np.zeros(1))]
        if contact.kind == "side":
            # a tool that leans aside must turn with the object; those come last
            azimuths = azimuths[:1]
        yaws = along.tip.yaws
        rolls = contact.kind == "top" and float(np.ptp(yaws)) > TURNING
        return tool_options(azimuths, float(yaws[middle]), axes, rolls=rolls)

    def contact_clearance(self, postures: Array) -> Gap:
        """Tightest gap of postures (k, n) along the contact.

        Every fourth posture is checked first. If a gap is already too small, the others
        are not checked.
        """
        coarse = self._along_contact(postures, GLANCE)
        return self._along_contact(postures, 1) if coarse.clear else coarse

    def _along_contact(self, postures: Array, step: int) -> Gap:
        """Tightest gap of every ``step``-th posture along the contact."""
        carried = {name: poses[::step] for name, poses in self._carried.items()}
        shapes = self.object_path.shapes[::step]
        return self.clearance.min_distance(
            postures[::step], shapes, touching=True, bodies=carried
        )

    def touch_clearance(self, postures: Array) -> Gap:
        """Tightest gap of postures (k, n) from near the object to the contact."""
        poses = self.object_path.shapes[:1] * len(postures)
        return self.clearance.min_distance(postures, poses, touching=True)

    def waiting_clearance(self, q: Array) -> Gap:
        """Tightest gap of an arm that waits in a posture (n,) while the object, and
        anything it pushes, moves.
        """
        shapes = self.object_path.shapes
        postures = np.repeat(q[None], len(shapes), axis=0)
        return self.clearance.min_distance(
            postures, shapes, touching=False, bodies=self._pushed
        )

    @cached_property
    def _pushed(self) -> dict[str, list[Pose2]]:
        """Paths, by name, of the bodies that the object pushes as a tool or along its
        path, with as many poses as the object.
        """
        tool = self.query.tool
        if tool is None:
            return self._carried
        body = next(o for o in self.query.scene.obstacles if o.name == tool.body)
        ends = (body.pose, tool.goal)
        shares = np.linspace(0.0, 1.0, len(self.object_path.shapes))
        path = [_between(ends, float(share)) for share in shares]
        return {**self._carried, body.name: path}

    @cached_property
    def _carried(self) -> dict[str, list[Pose2]]:
        """Paths, by name, of the obstacles that the object pushes along its path."""
        query = self.query
        shape = query.body.shape
        return carried_ways(shape, query.yielding, self.object_path.shapes)

    def approach_clearance(self, model: Clearance, postures: Array) -> Gap:
        """Tightest gap of postures (m, n) during the approach."""
        gap = self._gap(model, postures)
        near = self._near
        if near is None or gap.pair != near.pair:
            return gap
        return replace(gap, allowed=near.distance - LEAVING)

    def _gap(self, model: Clearance, postures: Array) -> Gap:
        poses = self.object_path.shapes[:1] * len(postures)
        return model.min_distance(postures, poses, touching=False)

    @cached_property
    def _near(self) -> Gap | None:
        """Gap of an arm that stands too near, as one whose retreat a joint limit has
        ended, but may leave. None: it stands clear, or touches.
        """
        if self.start is None:
            return None
        gap = self._gap(self.clearance, self.start[None])
        return None if gap.clear or gap.distance < 2.0 * LEAVING else gap

    def free(self, model: Clearance, q: Array) -> bool:
        """Whether an arm keeps its clearance in a posture (n,) during the approach."""
        return self.approach_clearance(model, q[None]).clear


def _between(ends: tuple[Pose2, Pose2], share: float) -> Pose2:
    start, end = ends
    turn = math.remainder(
        end.yaw - start.yaw, 0.5 * math.pi
    )  # whichever side is pushed
    return Pose2(
        start.x + share * (end.x - start.x),
        start.y + share * (end.y - start.y),
        start.yaw + share * turn,
    )


def object_path(plan: Plan) -> ObjectPath:
    """Path of the object over all segments of ``plan``, sampled by arc length."""
    lengths: list[float] = []
    bodies: list[Pose2] = []
    done = 0.0
    for segment in plan.segments:
        length = segment.path.length
        X_VB = segment.X_BV.inverse()
        turned = sum(
            abs(b.yaw - a.yaw)
            for (_, a), (_, b) in pairwise(segment.path.section_starts)
        )
        count = max(8, math.ceil((length + TURN_ARM * turned) / STEP))
        grid = np.linspace(0.0, length, count + 1)
        if lengths:
            grid = grid[1:]
        lengths += [done + float(s) for s in grid]
        bodies += [segment.path.pose(float(s)).compose(X_VB) for s in grid]
        done += length
    X_BG = plan.task.X_GB.inverse()
    shapes = [X.compose(X_BG) for X in bodies]
    return ObjectPath(np.array(lengths), bodies, shapes)
