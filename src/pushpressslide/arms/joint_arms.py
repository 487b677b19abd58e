"""The arms of a plan in a simulator, each with the interface of its robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pushpressslide.arms.command_line import CommandLine, random_streams
from pushpressslide.arms.faults import (
    FaultyDrives,
    FaultyPositionDrives,
    JointFaults,
    joint_faults,
)
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import ArmModel, Drives, PositionDrives
from pushpressslide.arms.servo_arm import ServoArm
from pushpressslide.arms.torque_arm import TorqueArm
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.plan import Plan
from pushpressslide.core.scene import Robot
from pushpressslide.core.truth import EXACT, Truth

MakeModel = Callable[[Robot, Truth], ArmModel]
"""Makes the model of an arm that differs from a robot by the truth."""


def joint_arms(
    plan: Plan, make_model: MakeModel, drives: Sequence[Drives], options: RunOptions
) -> list[JointArm]:
    """Arms on simulated ``drives``, one for each robot. They are as the task's
    ``truth`` says; their controllers know the robots alone.
    """
    truth = plan.task.truth
    dt = plan.query.motion.control_period
    stiffness = options.execution.joint_stiffness
    arms: list[JointArm] = []
    for i, (robot, own) in enumerate(zip(plan.query.scene.robots, drives, strict=True)):
        encoders, motors, commands = random_streams(options.seed, i)
        model = make_model(robot, EXACT)
        if truth != EXACT:
            effort = model.facts.effort_limit
            faults = joint_faults(truth, effort, encoders, motors)
            own = _faulty(own, make_model(robot, truth), faults, dt)
        line: CommandLine[Any]
        if robot.interface == "torque":
            line = CommandLine(truth, commands, dt, robot.delay)
            arms.append(TorqueArm(model, own, stiffness, line, robot.delay))
        else:  # whose servo has the known delay
            line = CommandLine(truth, commands, dt)
            arms.append(ServoArm(model, own, robot, line))
    return arms


def _faulty(
    drives: Drives, model: ArmModel, faults: JointFaults, dt: float
) -> FaultyDrives:
    if isinstance(drives, PositionDrives):
        return FaultyPositionDrives(drives, model, faults, dt)
    return FaultyDrives(drives, model, faults, dt)
