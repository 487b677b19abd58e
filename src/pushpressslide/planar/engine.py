"""The fast engine: runs a plan quasi-statically on the exact limit surface, with the
same controller as Drake.

The truth is the task's own friction, mass and shape; the controller sees only what a
robot would see.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from pushpressslide.control.controller import Controller
from pushpressslide.control.recording import Recorder
from pushpressslide.control.sensing import Sensor
from pushpressslide.core.control import Measurement
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import ReasonCode, Record
from pushpressslide.planar.world import World, WorldState

TIPPING_TIME = 0.1  # [s] of load off the base that ends a run
OVERHEAD = 6.0  # [s] typical time of touch and release, for the progress


def run(
    plan: Plan,
    *,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
    stop: Callable[[], bool] = bool,
) -> Record:
    """Run ``plan`` from the task's true start and return its record; deterministic for
    a seed.

    ``stop`` is asked at every tick whether to end the run (reason "interrupted").
    Movable obstacles are not modelled: the object passes through them.
    """
    placements = plan.placements
    task = plan.part(placements[0][0])
    dt = task.motion.control_period
    X_BG = task.object.X_GB.inverse()
    number = 0
    world = World(task, placements[0][0].contacts, dt)
    here = world.start(task.true_start, task.start, task.motion.approach_distance)
    controller = Controller(plan)
    sensor = Sensor(task.sensing, seed, dt)
    recorder = Recorder(plan)
    expected = OVERHEAD * len(placements) + plan.duration
    time = 0.0
    tipping = 0.0
    started = perf_counter()

    def measured(world_state: WorldState) -> Measurement:
        return sensor.measure(
            Measurement(time, world_state.X_WB.compose(X_BG), world_state.tips)
        )

    measurement = measured(here)
    state = controller.init(measurement)
    reason: tuple[ReasonCode, str] = (
        "time_limit",
        f"limits.time of {task.limits.time:g} s is over",
    )
    while time < task.limits.time:
        tick = perf_counter()
        followed = state.reference
        commands, log, state = controller.step(state, measurement)
        total = perf_counter() - tick
        after = world.step(here, commands)
        at_G = after.twist.moved_to(X_BG.position)
        recorder.add(
            time=time,
            log=log,
            true_pose=here.X_WB.compose(X_BG),
            twist=(*here.X_WB.rotate((at_G.vx, at_G.vy)), at_G.w),
            commands=commands,
            tips=[tip.position for tip in here.tips],
            forces=[tip.force for tip in after.tips],
            ticks=(*state.ticks, 0.0, total),
            followed=followed,
        )
        here = after
        time = time + dt
        tipping = tipping + dt if here.tipping else 0.0
        measurement = measured(here)
        if progress is not None:
            progress(time, expected)
        more = number + 1 < len(placements)
        if state.phase == "done" and more and state.failure is None:
            number += 1
            lasting = controller.lasting
            first = placements[number][0]
            part = plan.part(first)
            world = World(part, first.contacts, dt)
            here = world.regrasp(here, part.motion.approach_distance, lasting)
            measurement = measured(here)
            controller = Controller(plan, number)
            recorder.begin(number)
            state = controller.init(
                measurement,
                tuple(c if i in lasting else None for i, c in enumerate(commands)),
            )
        if state.phase == "done":
            reason = state.failure or ("goal_reached", "")
            break
        if tipping > TIPPING_TIME:
            what = "tips over: the centre of pressure has left its base"
            if not any(-tip.force[2] for tip in here.tips) and any(
                task.weight_in_plane
            ):
                what = "falls: nothing presses it on the wall"
            reason = ("diverged", f"the object {what}")
            break
        if stop():
            reason = ("interrupted", f"stopped by the user at {time:.1f} s")
            break
    return recorder.record(
        reason, "planar", seed, perf_counter() - started, {"time_step": dt}
    )
