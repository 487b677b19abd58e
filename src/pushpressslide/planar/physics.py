"""The planar world as clock, tracker and source of the true state.

The truth is the task's own friction, mass and shape, with the errors of ``truth``; the
controller sees only what a robot would measure.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pushpressslide.control.cell import TrueState
from pushpressslide.control.disturbance import Pushes
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import TipCommand, TipState
from pushpressslide.core.plan import Plan
from pushpressslide.core.state import WorldState
from pushpressslide.core.true_task import true_task
from pushpressslide.planar.uneven_friction import UnevenGround
from pushpressslide.planar.world import World, resting
from pushpressslide.planning.side_contacts import before_contacts
from pushpressslide.selection.placement_planner import PlacementPlanner, PlansAlone

TIPPING_TIME = 0.1  # [s] for which the load may leave the base before the run ends


class PlanarPhysics:
    """An object and tips without arms. It serves as clock, tracker, placements and
    source of the true state.
    """

    simulated = True

    def __init__(
        self, plan: Plan, start: WorldState | None = None, seed: int = 0
    ) -> None:
        """Put object and tips at the start of a run. ``seed`` draws the true world."""
        task = plan.task
        query = plan.query
        self.time = 0.0  # [s]
        self.facts: dict[str, Any] = {"time_step": query.motion.control_period}
        self._pushes = Pushes(task)
        if self._pushes:
            self.facts["pushed"] = self._pushes.times
        # for each tip, until another one takes its place
        self.commands: list[TipCommand | None] = [None] * len(task.robots)
        self.period = query.motion.control_period  # [s]
        self._task = task
        self._X_BG = task.object.X_GB.inverse()
        self._seed = seed
        self._ground = UnevenGround.if_uneven(task.truth, seed)
        self._world = self._true_world(plan)
        gap = before_contacts(query.scene, query.motion, plan.contacts)
        self.now = self._world.start(plan.true_start, query.start, gap)
        self._before = self.now  # one tick ago
        if start is not None:
            self.put(map(resting, start.tips))
        self._X_WG = self.now.X_WB.compose(self._X_BG)
        self._X_WG_before = self._X_WG
        self._tipping = 0.0  # [s] since when the load is off the base

    def put(self, tips: Iterable[TipState]) -> None:
        """Begin with the tips in these states."""
        self.now = self.now._replace(tips=tuple(tips))
        self._before = self.now

    def read(self) -> StampedPose:
        """The object's pose."""
        return StampedPose(self.time, self._X_WG)

    def advance(self) -> None:
        """Advance by one control period."""
        self._before = self.now
        self._X_WG_before = self._X_WG
        pushed = None
        if self._pushes:
            pushed = self._pushes.wrench(self._X_WG, self.time)
        self.now = self._world.step(self.now, self.commands, pushed, self.time)
        self._X_WG = self.now.X_WB.compose(self._X_BG)
        self.time = self.time + self.period
        self._tipping = self._tipping + self.period if self.now.tipping else 0.0

    def observe(self) -> TrueState:
        """True state of the last completed tick."""
        before = self._before
        twist = self.now.twist.moved_to(self._X_BG.position)
        velocity = before.X_WB.rotate((twist.vx, twist.vy))
        return TrueState(
            self._X_WG_before,
            before.tips,
            (*velocity, twist.w),
            tuple(tip.force for tip in self.now.tips),
        )

    def failure(self) -> str | None:
        """Reason why the run cannot go on: the object tips over or falls. None
        otherwise.
        """
        if self._tipping <= TIPPING_TIME:
            return None
        pressed = any(-tip.force[2] for tip in self.now.tips)
        if any(self._task.scene.weight_along) and not pressed:
            return "the object falls: nothing presses it on the wall"
        return "the object tips over: the centre of pressure has left what carries it"

    def prepare(self) -> PlacementPlanner:
        """A placement planner that accepts any plan."""
        return PlansAlone()

    def restore(self) -> None:
        """Do nothing: tips without arms have no joint paths."""

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Take the contacts of the next placement. The tips keep their positions."""
        self._world = self._true_world(placement)

    def _true_world(self, placement: Plan) -> World:
        """The world in which the contacts of a placement act."""
        task = true_task(placement.task, self._seed)
        return World(task, placement.contacts, self.period, self._ground)
