"""A cell whose robot runs in a thread of its own, at a rate and on a clock of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Applied, ArmState, Cell, TipAlone
from pushpressslide.control.limits import JUMP
from pushpressslide.control.run_loop import RunLoop, RunOptions, run_loop
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import ArmCommand, Commands, TipCommand
from pushpressslide.core.errors import TaskError
from pushpressslide.core.truth import Truth
from pushpressslide.planar.physics import PlanarPhysics

RATE = 1000.0  # [Hz] of the robot's own clock
PAUSE = 2e-4  # [s] of a wall clock that it sleeps between two of its periods
PICTURE = 0.02  # [s] between two pictures of the camera
BREAKS = 5.0  # [s] at which a reference jumps, in the push
PLAN = pps.plan(pps.load_task("rear-push-rear"))


class Robot:
    """Obeys the last command a thousand times a second, whoever plans meanwhile."""

    simulated = False

    def __init__(self) -> None:
        task = PLAN.task
        quick = replace(task, motion=replace(task.motion, control_period=1.0 / RATE))
        self.physics = PlanarPhysics(replace(PLAN, task=quick))
        self.period = task.motion.control_period
        self.due = 0.0  # [s] when the next control period begins
        self.running = False
        self.picture = StampedPose(0.0, task.start)
        self.moment = threading.Condition()
        self.thread = threading.Thread(target=self.run)

    @property
    def time(self) -> float:
        return self.physics.time

    def run(self) -> None:
        while self.running:
            with self.moment:
                self.physics.advance()
                seen = self.physics.read()
                if seen.time >= self.picture.time + PICTURE:
                    self.picture = seen
                self.moment.notify_all()
            time.sleep(PAUSE)

    def advance(self) -> None:
        with self.moment:
            self.due = max(self.due + self.period, self.time)
            self.moment.wait_for(lambda: self.time >= self.due, timeout=10.0)

    def failure(self) -> str | None:
        return self.physics.failure()


class Camera:
    """Shows each picture once."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.shown = -1.0  # [s]

    def read(self) -> StampedPose | None:
        picture = self.robot.picture
        if picture.time <= self.shown:
            return None
        self.shown = picture.time
        return picture


class Tip(TipAlone):
    """The robot's tip, over a connection."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def connect(self) -> None:
        self.robot.running = True
        self.robot.thread.start()

    def disconnect(self) -> None:
        self.robot.running = False
        self.robot.thread.join()

    def read(self) -> ArmState:
        with self.robot.moment:
            return ArmState(self.robot.time, self.robot.physics.now.tips[0])

    def send(self, command: ArmCommand) -> Applied:
        with self.robot.moment:
            tip = command if isinstance(command, TipCommand) else None
            self.robot.physics.commands[0] = tip
        return Applied()


def cell_of(robot: Robot) -> Cell:
    return Cell("robot", robot, [Tip(robot)], Camera(robot), robot.physics)


@contextmanager
def disconnected(robot: Robot) -> Iterator[None]:
    """Check that no thread is left behind."""
    yield
    assert not robot.thread.is_alive()


def jumps_once(seconds: float, commands: Commands) -> Commands:
    if not BREAKS <= seconds < BREAKS + 0.01:
        return commands
    return tuple(
        replace(c, position=(c.position[0], c.position[1], c.position[2] + 0.05))
        if isinstance(c, TipCommand)
        else c
        for c in commands
    )


def test_a_shipped_task_is_done_on_the_robots_own_clock() -> None:
    robot = Robot()
    with disconnected(robot):
        record = run_loop(cell_of(robot), PLAN)
    figures = pps.result(record)
    assert figures["success"] is None  # nothing but the robot's sensors tells
    assert figures["verified"], record.reason_text
    assert record.engine == "robot"
    # nobody but the camera tells where the object is
    assert len(np.unique(record.arrays["object_pose"], axis=0)) > 100


def test_the_robot_holds_while_a_recovery_is_planned() -> None:
    robot = Robot()
    with disconnected(robot):
        record = run_loop(cell_of(robot), PLAN, RunOptions(disturb=jumps_once))
    (event,) = record.meta["events"]
    assert event["code"] == "reference_jump"
    assert event["recovered"]
    assert pps.result(record)["verified"], record.reason_text
    # it was commanded all the time, by references that never jumped
    references = record.arrays["tip_reference"][:, 0]
    steps = np.linalg.norm(np.diff(references, axis=0), axis=1)
    after = record.arrays["time"][1:] > event["time"]
    assert steps[after].max() < JUMP
    held = steps[after] == 0.0  # tick by tick
    assert np.count_nonzero(held) > 5


def test_a_truth_of_simulated_arms_is_refused() -> None:
    task = replace(PLAN.task, truth=Truth(command_delay=0.004))
    with pytest.raises(TaskError, match=r"truth\.command_delay: 0\.004"):
        RunLoop(cell_of(Robot()), replace(PLAN, task=task))


def test_an_arm_is_disconnected_from_a_run_that_breaks() -> None:
    robot = Robot()

    def breaks(seconds: float, expected: float) -> None:
        raise ZeroDivisionError

    with disconnected(robot):
        try:
            run_loop(cell_of(robot), PLAN, RunOptions(progress=breaks))
        except ZeroDivisionError:
            return
    raise AssertionError
