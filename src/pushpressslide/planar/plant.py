"""The planar world as a plant: quasi-static, on the exact limit surface.

The truth is the task's own friction, mass and shape; the controller sees only what a
robot would see.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.control.plant import PlantRow
from pushpressslide.core.control import Commands, Measurement, TipCommand
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.state import WorldState
from pushpressslide.planar.world import World, resting
from pushpressslide.planning.side_contacts import before_contacts
from pushpressslide.selection.preparation import PlansAlone, Preparation

TIPPING_TIME = 0.1  # [s] of load off the base that ends a run
TOUCH_AND_RELEASE = 6.0  # [s] typical time of both, for the progress


class PlanarPlant:
    """An object and tips without arms."""

    name = "planar"
    joint_paths: tuple[JointPath, ...] = ()
    arm_limits: tuple[ArmLimits, ...] = ()

    def __init__(self, plan: Plan, begin: WorldState | None = None) -> None:
        """Put the object at its true start, and the tips before their contacts or where
        they are as the run begins.
        """
        task = plan.task
        query = plan.query
        self.time = 0.0  # [s]
        self.overhead = TOUCH_AND_RELEASE * len(plan.placements)
        self._period = query.motion.control_period
        self._task = task
        self._X_BG = task.object.X_GB.inverse()
        self._world = World(task, plan.contacts, self._period)
        gap = before_contacts(query.scene, query.motion, plan.contacts)
        self._now = self._world.start(plan.true_start, query.start, gap)
        if begin is not None:
            self._now = self._now._replace(tips=tuple(map(resting, begin.tips)))
        self._before = self._now  # one tick ago
        self._commands: list[TipCommand | None] = []
        self._tipping = 0.0  # [s] since when the load is off the base

    @property
    def meta(self) -> Mapping[str, Any]:
        """The time step [s]."""
        return {"time_step": self._period}

    def readings(self) -> tuple[ArmReading, ...]:
        """Return nothing: tips move without arms."""
        return ()

    def measure(self) -> Measurement:
        """Return pose and tips; a tip's force is that of the tick before."""
        return Measurement(
            self.time, self._now.X_WB.compose(self._X_BG), self._now.tips
        )

    def apply(self, commands: Commands) -> None:
        """Command every tip until the next call; only tip commands move them."""
        self._commands = [c if isinstance(c, TipCommand) else None for c in commands]

    def advance(self) -> None:
        """Let one control period pass."""
        self._before = self._now
        self._now = self._world.step(self._now, self._commands)
        self.time = self.time + self._period
        self._tipping = self._tipping + self._period if self._now.tipping else 0.0

    def row(self) -> PlantRow:
        """Return twist and forces of the tick."""
        twist = self._now.twist.moved_to(self._X_BG.position)
        velocity = self._before.X_WB.rotate((twist.vx, twist.vy))
        forces = tuple(tip.force for tip in self._now.tips)
        return PlantRow((*velocity, twist.w), forces)

    def diverged(self) -> str | None:
        """Return that the object tips over or falls, or None."""
        if self._tipping <= TIPPING_TIME:
            return None
        pressed = any(-tip.force[2] for tip in self._now.tips)
        if any(self._task.scene.weight_along) and not pressed:
            return "the object falls: nothing presses it on the wall"
        return "the object tips over: the centre of pressure has left what carries it"

    def prepare(self) -> Preparation:
        """Return a preparation that takes any plan."""
        return PlansAlone()

    def hand_over(self, placement: Plan, lasting: frozenset[int]) -> None:
        """Take the contacts of the next placement; the tips stay where they are."""
        self._world = World(placement.task, placement.contacts, self._period)
