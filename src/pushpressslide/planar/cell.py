"""The planar world as a cell: quasi-static, on the exact limit surface."""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.arms.command_line import CommandLine, random_streams
from pushpressslide.control.cell import Applied, Arm, ArmState, Cell, TipAlone
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.control import ArmCommand, TipCommand
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.scene import Robot
from pushpressslide.core.task import Task
from pushpressslide.core.truth import EXACT, Truth, refuse_truth
from pushpressslide.planar.misplaced_tip import MisplacedTip, misplacement
from pushpressslide.planar.physics import PlanarPhysics
from pushpressslide.planar.servo_tip import ServoTip


def planar_cell(plan: Plan, options: RunOptions | None = None) -> Cell:
    """Cell with the object of ``plan`` at its true start, and the tips before their
    contacts or at the positions in the state in which a run with these ``options``
    begins.

    Raises TaskError for a ``truth`` of joints, obstacles or a ridge, and for a tilt on
    which the object slides by itself.
    """
    options = options or RunOptions()
    task = plan.task
    _refuse_truth(task)
    _refuse_balls(task)
    physics = PlanarPhysics(plan, options.begin, options.true_world_seed)
    scene = plan.query.scene
    frame = scene.support.frame
    places = [misplacement(task.truth, base, frame) for base in scene.bases]
    exact = task.truth == EXACT
    if options.begin is None and not exact:
        starts = zip(places, physics.now.tips, strict=True)
        physics.put(place.tip(tip) for place, tip in starts)
    tips = [_tip(physics, i, robot) for i, robot in enumerate(task.robots)]
    if not exact:
        lines = [
            _line(task.truth, i, options.seed, physics.period) for i in range(len(tips))
        ]
        tips = list(map(MisplacedTip, tips, places, lines))
    return Cell("planar", physics, tips, physics, physics, physics)


def _refuse_truth(task: Task) -> None:
    """Raise TaskError for errors that need joints, obstacles, heights or inertia."""
    source = task.source or task.name
    truth = task.truth
    where = "with engine planar, which has no joints"
    refuse_truth(truth, truth.for_tips(), source, where)
    where = "with engine planar, which has no obstacles"
    refuse_truth(truth, replace(truth, obstacle_offset=0.0), source, where)
    where = "with engine planar, which has no heights"
    refuse_truth(truth, replace(truth, ridge=0.0), source, where)
    x, y, z = task.support.frame.components(truth.gravity)
    if (
        truth.tilt
        and task.scene.rests
        and math.hypot(x, y) > -task.support.friction * z
    ):
        where = "with engine planar, on which an object that slides by itself stops"
        refuse_truth(truth, replace(truth, tilt=0.0), source, where)


def _refuse_balls(task: Task) -> None:
    """Raise TaskError for a disturbance by a ball, which needs a third dimension."""
    for i, knock in enumerate(task.disturbances):
        if knock.ball is not None:
            allowed = "allowed on engine planar: push"
            source = task.source or task.name
            field = f"disturbances[{i}].ball"
            raise TaskError(source, field, knock.ball.side, allowed)


def _tip(physics: PlanarPhysics, index: int, robot: Robot) -> Arm:
    """Tip with the interface of its robot."""
    if robot.interface == "torque":
        return PlanarTip(physics, index)
    return ServoTip(physics, index, robot)


def _line(truth: Truth, arm: int, seed: int, dt: float) -> CommandLine[ArmCommand]:
    *_, commands = random_streams(seed, arm)
    return CommandLine(truth, commands, dt)


class PlanarTip(TipAlone):
    """One tip of the planar world."""

    def __init__(self, physics: PlanarPhysics, index: int) -> None:
        """Attach to the tip number ``index`` of the planar world."""
        self._physics = physics
        self._index = index

    def read(self) -> ArmState:
        """Position and velocity of the tip, and the force of the previous tick."""
        return ArmState(self._physics.time, self._physics.now.tips[self._index])

    def send(self, command: ArmCommand) -> Applied:
        """Execute a tip command. Only commands move the tip."""
        tip = command if isinstance(command, TipCommand) else None
        self._physics.commands[self._index] = tip
        return Applied()
