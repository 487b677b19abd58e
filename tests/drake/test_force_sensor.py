"""Measurements of the tips' force sensors."""

import numpy as np

import pushpressslide as pps
from pushpressslide.control.approach import JointApproach
from pushpressslide.sim.arm_library import joint_paths_of
from pushpressslide.sim.cell import drake_cell
from pushpressslide.sim.station import Station

TICKS = 150
STARTED = 5  # ticks after which the arms are under way


def test_an_arm_in_free_motion_feels_next_to_nothing() -> None:
    plan = pps.plan(pps.load_task("parallel-push"))
    paths = joint_paths_of(plan)
    station = Station(plan, time_step=0.002)
    cell = drake_cell(plan, station, paths)
    approach = JointApproach(plan.task.start, cell.joint_paths, (None, None), 0.0)
    felt = []
    speeds = []
    for _ in range(TICKS):
        tips = [arm.read().tip for arm in cell.arms]
        felt.append([tip.force for tip in tips])
        speeds.append([tip.velocity for tip in tips])
        commands, _ = approach.step(cell.clock.time)
        for arm, command in zip(cell.arms, commands, strict=True):
            arm.send(command)
        cell.clock.advance()
    forces = np.linalg.norm(felt[STARTED:], axis=-1)
    # both tips are accelerated, which alone takes several times what is felt
    own = station.scene.robots[0].tip_body.default_mass()
    change = np.diff(speeds[STARTED:], axis=0) / plan.task.motion.control_period
    inertial = own * np.linalg.norm(change, axis=-1)
    assert (inertial.max(axis=0) > 0.01).all()
    assert forces.max() < 0.1 * inertial.max(axis=0).min()
