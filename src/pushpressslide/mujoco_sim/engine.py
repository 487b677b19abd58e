"""Execution of a plan in MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.control.disturbance import ball_of
from pushpressslide.control.knocker import Knocker, with_knock
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.mujoco_sim.cell import mujoco_cell


def run(
    plan: Plan,
    library: ArmLibrary,
    paths: Sequence[tuple[ArmPath, ...]],
    options: RunOptions | None = None,
    *,
    time_step: float | None = None,
) -> Record:
    """Run ``plan`` in MuJoCo and return its record, deterministic for a seed.

    ``paths`` are the joint paths of each placement; ``library`` plans those of
    recoveries. ``time_step`` [s] is the physics step (default: by the object's mass).
    If a ball disturbs the object, ``knocked`` in the record's meta holds the
    displacement.
    """
    options = options or RunOptions()
    knocker = None if ball_of(plan.task) is None else Knocker(plan)
    cell = mujoco_cell(
        plan,
        library,
        paths,
        options,
        step=time_step,
        knocker=knocker,
    )
    record = run_loop(cell, plan, options)
    return record if knocker is None else with_knock(record, knocker)
