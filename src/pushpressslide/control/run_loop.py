"""The run loop: it runs one plan on any plant.

Commands come from the approach while the arms move freely, then from the controller.
When a placement is done the next one is handed over. A guard sees every command before
it is applied; where a limit is broken the arms stop safely. The controller, the guard,
the watches, the plant, the user or the time limit end the run.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any

from pushpressslide.control.approach import (
    Approach,
    JointApproach,
    TipApproach,
    TipPath,
    tip_path,
)
from pushpressslide.control.controller import Controller
from pushpressslide.control.limits import Guard
from pushpressslide.control.plant import Plant, Situation
from pushpressslide.control.recording import Recorder, Tick
from pushpressslide.control.recovery import RECOVERABLE, planned_anew, restart
from pushpressslide.control.sensing import Sensor
from pushpressslide.control.state import ControllerState, findings, tip_position
from pushpressslide.control.watches import Watch
from pushpressslide.core import margins
from pushpressslide.core.control import (
    Commands,
    ControlLog,
    Measurement,
    TipCommand,
    TipCommands,
)
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.identification.findings import NOTHING
from pushpressslide.planning.side_contacts import before_contacts

AT_BASE = 0.01  # [m] from its base at which a tip without an arm waits
PROGRESS_TICKS = 25  # between two reports of the progress


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What a caller may ask of a run on any plant."""

    seed: int = 0  # of the sensor noise
    # called with time and expected duration [s] every PROGRESS_TICKS
    progress: Callable[[float, float], None] | None = None
    # asked at every tick whether to end the run with reason "interrupted"
    stop: Callable[[], bool] = bool
    # changes the controller's commands at a time [s] on their way to the guard and the
    # arms, until a limit is broken; the record keeps the commands as given
    disturb: Callable[[float, Commands], Commands] | None = None
    # that the run goes on from; None: the task's start, with the arms before the object
    begin: Situation | None = None


def run_loop(
    plant: Plant,
    plan: Plan,
    options: RunOptions | None = None,
    watches: Sequence[Watch] = (),
) -> Record:
    """Run ``plan`` on ``plant`` from its start and return the record.

    Nothing is decided by wall time: a plant that is deterministic gives the same record
    for the same seed.
    """
    loop = RunLoop(plant, plan, options or RunOptions(), watches)
    with _uncollected():
        return loop.run()


@contextmanager
def _uncollected() -> Iterator[None]:
    """Leave out Python's search for unreachable cycles, which a tick of 0.1 s in each
    run waited for: a run makes none that are worth it.
    """
    collected = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collected:
            gc.enable()


class RunLoop:
    """One run: the present placement, what is ahead, and what ends it."""

    def __init__(
        self, plant: Plant, plan: Plan, options: RunOptions, watches: Sequence[Watch]
    ) -> None:
        task = plan.part(plan.segments[0])
        period = task.motion.control_period
        self.plan = plan
        self.plant = plant
        self.options = options
        self.time_limit = task.limits.time
        self.recoveries = task.motion.recoveries  # left
        self.events: list[dict[str, Any]] = []  # what was recovered from
        # plans that others took the place of, and how many placements were begun of each
        self.earlier: list[tuple[Plan, int]] = []
        self.sensor = Sensor(task.sensing, options.seed, period)
        goes_on = options.begin is not None
        self.guard = Guard(
            task.limits.normal_force, period, plant.arm_limits, anew=goes_on
        )
        self.breach: Ending | None = None  # the limit that was broken
        self.recorder = Recorder(plan)
        self.watches = (self._finished, *watches, self._diverged, self._stopped)
        self.ticks = 0
        self.expected = plant.overhead + plan.duration
        self.placements = plan.by_placement
        self.number = 0  # of the present placement
        self.state: ControllerState | None = None  # None before the touch
        before = plant.measure() if goes_on else None
        self._begin((None,) * len(task.robots), plant.time, before)

    def run(self) -> Record:
        """Go through all ticks and return the record."""
        started = perf_counter()
        ending = Ending("time_limit", f"limits.time of {self.time_limit:g} s is over")
        while self.plant.time < self.time_limit:
            tick, measurement = self._tick()
            self.recorder.add(tick)
            if self._placement_done() and self.number + 1 < len(self.placements):
                self._hand_over(tick, measurement)
            ended = self._ending(tick)
            if ended is not None and not self._recovers(ended, tick, measurement):
                ending = ended
                break
            self._report(tick.truth.time)
        arrays = self.recorder.arrays()
        wall_time = perf_counter() - started
        plan = self.plan
        for earlier, count in reversed(self.earlier):
            plan = earlier.begun(count, plan)
        return self.recorder.record(
            arrays,
            self.breach or ending,
            self.plant.name,
            self.options.seed,
            wall_time,
            plan,
            {**self.plant.meta, "events": self.events},
        )

    def _tick(self) -> tuple[Tick, Measurement]:
        """Pass one control period; return what came of it, and what was measured."""
        began = perf_counter()
        truth = self.plant.measure()
        measurement = self.sensor.measure(truth)
        followed = self.state.reference if self.state is not None else None
        commands, log = self._decide(measurement)
        applied = self._disturbed(truth.time, commands, log)
        if self.breach is None:
            self.breach = self._judged(measurement, applied)
            if self.breach is not None:
                self._stop(self.breach, measurement)
                commands, log = self._decide(measurement)
                applied = commands
        self.plant.apply(applied)
        total = perf_counter() - began
        self.plant.advance()
        decided = self.state.ticks if self.state is not None else (0.0, 0.0)
        wall_times = (*decided, total)
        tick = Tick(truth, commands, log, followed, self.plant.row(), wall_times)
        return tick, measurement

    def _decide(self, measurement: Measurement) -> tuple[Commands, ControlLog]:
        if measurement.time < self.approach.arrival:
            return self.approach.step(measurement.time)
        if self.state is None:
            self.state = self.controller.init(measurement, self.approach.held)
        if self.state.phase == "release" and self.guard.cramped(self.plant.readings()):
            self.state = self.controller.halted(self.state, measurement)
        commands, log, self.state = self.controller.step(self.state, measurement)
        return commands, log

    def _judged(self, measurement: Measurement, commands: Commands) -> Ending | None:
        """Return the limit that is broken at this tick."""
        if self.state is None:
            forces = [math.hypot(*tip.force) for tip in measurement.tips]
        else:
            forces = self.controller.normal_forces(self.state, measurement)
        return self.guard.breach(forces, self.plant.readings(), commands)

    def _stop(self, breach: Ending, measurement: Measurement) -> None:
        """Stop safely: slow down, then draw back or, where nothing else carries the
        object, hold it.
        """
        if self.state is None:
            self.approach.halt(measurement.time)
        else:
            failure = (breach.code, breach.text)
            self.state = self.controller.stop(self.state, measurement, failure)

    def _disturbed(self, time: float, commands: Commands, log: ControlLog) -> Commands:
        disturb = self.options.disturb
        stopping = self.breach is not None
        if disturb is None or stopping or log.phase == "approach":
            return commands
        return disturb(time, commands)

    def _begin(
        self, held: TipCommands, time: float, measurement: Measurement | None
    ) -> None:
        """Begin the present placement at ``time`` [s], with the tips as measured."""
        placement = self.placements[self.number]
        task = placement.task
        paths = self.plant.joint_paths
        gap = before_contacts(task, placement.contacts)
        back = min((path.room for path in paths), default=math.inf)
        if paths:  # what the approach really leaves
            self.approach: Approach = JointApproach(task.start, paths, held, time)
            gap = min(gap, *(path.gap for path in paths))
        else:
            travel = tip_paths(placement, held, measurement)
            self.approach = TipApproach(task.start, travel, held, time)
        self.controller = Controller(self.plan, self.number, gap, back)
        self.guard.begin()
        self.state = None

    def _hand_over(self, tick: Tick, measurement: Measurement) -> None:
        """Begin the next placement; arms that keep their contact go on as commanded."""
        lasting = self.controller.lasting
        held = tuple(
            command if i in lasting and isinstance(command, TipCommand) else None
            for i, command in enumerate(tick.commands)
        )
        self.number += 1
        self.plant.hand_over(self.placements[self.number], lasting)
        self._begin(held, tick.truth.time, measurement)
        self.recorder.begin(self.plan, self.number)

    def _recovers(self, ending: Ending, tick: Tick, measurement: Measurement) -> bool:
        """Plan anew what is left, from where object and arms are, and begin it; return
        whether that can be done, and in time.
        """
        if self.recoveries == 0:
            return False
        pose = measurement.object_pose
        if self.state is not None:
            pose = self.controller.seen(self.state, measurement)
        why = self._lacks(self.breach or ending, pose)
        if why is None:
            return False
        time = tick.truth.time
        try:
            plan = self._planned_anew(pose, time)
        except InfeasibleTaskError as error:
            self._note(time, why, str(error))
            return False
        self._note(time, why)
        self._resume(plan, time, measurement)
        return True

    def _lacks(self, ending: Ending, pose: Pose2) -> Ending | None:
        """Return what went wrong, if arms that have drawn back could begin anew."""
        if ending.code == "goal_reached":
            return self.controller.missed(pose)
        return ending if ending.code in RECOVERABLE else None

    def _planned_anew(self, pose: Pose2, time: float) -> Plan:
        """Return the plan of what is left from ``pose``, X_WG.

        Raises InfeasibleTaskError where there is none that ends in time.
        """
        task = self.plan.task
        segment = self.controller.segments[0]
        found = NOTHING
        if self.state is not None:
            segment = self.state.segment
            found = findings(self.state)
        elif any(self.approach.held):
            raise InfeasibleTaskError("one arm still holds the object")
        if not task.scene.carried(pose):
            raise InfeasibleTaskError("nothing but the arms carries the object")
        begin = restart(task, segment, pose, found)
        plan = planned_anew(task, begin, self.plant.prepare)
        needed = plan.duration + margins.ARM.regrasp * len(plan.placements)
        if time + needed > self.time_limit:
            raise InfeasibleTaskError(
                f"another attempt takes {needed:.0f} s; limits.time leaves "
                f"{self.time_limit - time:.0f} s"
            )
        return plan

    def _note(self, time: float, why: Ending, lacking: str | None = None) -> None:
        """Note what went wrong, and what was lacking for another attempt."""
        self.events.append(
            {
                "time": time,
                "code": why.code,
                "text": why.text,
                "recovered": lacking is None,
                "lacking": lacking,
            }
        )

    def _resume(self, plan: Plan, time: float, measurement: Measurement) -> None:
        """Begin ``plan`` in place of the rest of the present one."""
        self.earlier.append((self.plan, self.number + 1))
        self.plan = plan
        self.placements = plan.by_placement
        self.number = 0
        self.recoveries -= 1
        self.breach = None
        self.guard = Guard(
            plan.task.limits.normal_force,
            plan.task.motion.control_period,
            self.plant.arm_limits,
            anew=True,
        )
        self.expected = time + margins.ARM.regrasp + plan.duration
        self.plant.hand_over(self.placements[0], frozenset())
        self._begin((None,) * len(plan.task.robots), time, measurement)
        self.recorder.begin(plan, 0)

    def _placement_done(self) -> bool:
        state = self.state
        return state is not None and state.phase == "done" and state.failure is None

    def _ending(self, tick: Tick) -> Ending | None:
        """Return the first ending that a watch finds."""
        for watch in self.watches:
            ending = watch(tick)
            if ending is not None:
                return ending
        return None

    def _finished(self, tick: Tick) -> Ending | None:
        if self.state is None:
            return self.breach if self.approach.at_rest(tick.truth.time) else None
        if self.state.phase != "done":
            return None
        failure = self.state.failure
        return Ending("goal_reached") if failure is None else Ending(*failure)

    def _diverged(self, tick: Tick) -> Ending | None:
        why = self.plant.diverged()
        return None if why is None else Ending("diverged", why)

    def _stopped(self, tick: Tick) -> Ending | None:
        if not self.options.stop():
            return None
        text = f"stopped by the user at {tick.truth.time:.1f} s"
        return Ending("interrupted", text)

    def _report(self, time: float) -> None:
        self.ticks += 1
        progress = self.options.progress
        if progress is not None and self.ticks % PROGRESS_TICKS == 0:
            progress(time, self.expected)


def tip_paths(
    placement: Plan, held: TipCommands, measurement: Measurement | None
) -> list[TipPath | None]:
    """Return the way of each tip without an arm, over the object: to before its planned
    contact, or to its robot's base, where a tip waits that has none. None for one that
    holds its contact, and at the start of a run.
    """
    task = placement.task
    paths: list[TipPath | None] = [None] * len(task.robots)
    if measurement is None:
        return paths
    X_WB = task.start.compose(task.X_GB)
    gap = before_contacts(task, placement.contacts)
    ends = {
        contact.arm: tip_position(
            contact, X_WB, task.robots[contact.arm].tip_radius, gap
        )
        for contact in placement.contacts
    }
    for arm, (robot, base) in enumerate(
        zip(task.robots, task.scene.bases, strict=True)
    ):
        begin = measurement.tips[arm].position
        waits = arm not in ends and math.dist(begin, base) < AT_BASE
        if held[arm] is None and not waits:
            above = task.object.shape.height + robot.tip_radius + gap
            paths[arm] = tip_path(begin, ends.get(arm, base), above)
    return paths
