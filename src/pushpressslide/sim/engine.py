"""Execution of a plan in Drake."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.control.knocker import with_knock
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.sim.arm_library import joint_paths_of
from pushpressslide.sim.cell import drake_cell
from pushpressslide.sim.driven import with_clearance
from pushpressslide.sim.station import LiveView, Station


def run(
    plan: Plan,
    options: RunOptions | None = None,
    *,
    paths: Sequence[tuple[ArmPath, ...]] | None = None,
    models: str = "generated",
    time_step: float | None = None,
    view: LiveView | None = None,
) -> Record:
    """Run ``plan`` in the hydroelastic simulation and return its record.

    For a given seed the record is deterministic on one kind of machine. ``paths`` are
    the joint paths of each placement, if they are already planned. Otherwise they are
    planned, and InfeasibleTaskError is raised before anything moves if an arm has none.
    ``models`` names the robot models; ``time_step`` [s] is the physics step (by default
    that of the task). ``view`` shows the run in real time. If a ball disturbs the
    object, ``knocked`` in the record's meta contains the displacement.
    """
    if paths is None:
        paths = joint_paths_of(plan)
    step = time_step or plan.query.motion.time_step
    options = options or RunOptions()
    seed = options.true_world_seed
    make = partial(Station, plan, models=models, time_step=step, seed=seed)
    station = make(view=view)
    spare = None
    disturbances = station.scene.disturbances
    if view is None and disturbances is None:  # neither can be handed over
        spare = partial(make, convex=True)
    cell = drake_cell(plan, station, paths, models, options, spare)
    record = with_clearance(run_loop(cell, plan, options), seed)
    ball = None if disturbances is None else disturbances.ball
    return record if ball is None else with_knock(record, ball.motion)
