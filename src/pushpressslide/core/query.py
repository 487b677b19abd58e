"""The input of a planner: one motion of an object to a goal."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pushpressslide.core import margins
from pushpressslide.core.motion import Limits, Motion, Tolerance, ToolUse
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import ObjectModel, Obstacle, Scene
from pushpressslide.core.sensing import Sensing

Ends = tuple[Pose2, Pose2]
"""Poses of an object at the start and at the goal of a motion."""


@dataclass(frozen=True, slots=True)
class MotionQuery:
    """One motion of the body of a scene, from a start to a goal.

    ``Task.queries`` derives one for each leg of a task.
    """

    scene: Scene  # as believed; its ``arm`` is that of ``motion``
    start: Pose2  # X_WG
    goal: Pose2  # X_WG
    motion: Motion
    limits: Limits
    tolerance: Tolerance
    sensing: Sensing
    tool: ToolUse | None
    modes: tuple[str, ...] | None  # None: all
    source: str  # task named in messages
    # whether it is one of many queries of a search for a sequence of motions
    from_search: bool = False
    may_push: bool = False  # whether movable obstacles may be pushed

    @property
    def body(self) -> ObjectModel:
        """The object to be moved."""
        return self.scene.body

    @property
    def X_GB(self) -> Pose2:
        """Pose of the body frame B in the shape's frame G."""
        return self.scene.body.X_GB

    @property
    def body_ends(self) -> Ends:
        """X_WB at start and goal."""
        X_GB = self.X_GB
        return self.start.compose(X_GB), self.goal.compose(X_GB)

    @property
    def planned_force(self) -> float:
        """Normal force [N] allowed in plans: less where a noisy force may stop the arms
        below the limit.
        """
        noise = margins.PLANNED_NOISE * self.sensing.force_noise
        return max(self.limits.planned_force - noise, 0.5 * self.limits.normal_force)

    @property
    def at_goal(self) -> bool:
        """Whether the object is at its goal already, so that nothing has to move."""
        alone = self.tool is None and not self.from_search
        return alone and self.tolerance.holds(self.start, self.goal)

    @property
    def yielding(self) -> tuple[Obstacle, ...]:
        """Obstacles that the object may push along its path."""
        if not self.may_push:
            return ()
        return tuple(body for body in self.scene.obstacles if body.may_move)

    @property
    def resisted_by_friction_alone(self) -> bool:
        """Whether nothing but the support's friction resists the object."""
        alone = self.tool is None and not self.may_push
        return alone and not any(self.scene.weight_along)

    @property
    def slides_unfelt(self) -> bool:
        """Whether the object may slide before a push is felt."""
        lightest = self.scene.surest_drag * self.scene.max_friction()
        return self.sensing.felt_force > lightest

    @property
    def touch_travel(self) -> float:
        """Distance [m] by which a touch moves the object before it is noticed."""
        if not self.slides_unfelt:
            return 0.0
        late = self.sensing.delay_of_pose + margins.ARM.seen_late
        return self.sensing.seen_motion + margins.ARM.light_speed * late

    def between(self, start: Pose2, goal: Pose2) -> MotionQuery:
        """The same query from one pose X_WG to another."""
        return replace(self, start=start, goal=goal)

    def moved_by(self, motion: Motion) -> MotionQuery:
        """Copy of the query with another motion, restricted to the arm that this motion
        names.
        """
        scene = replace(self.scene, arm=motion.only_arm)
        return replace(self, motion=motion, scene=scene)
