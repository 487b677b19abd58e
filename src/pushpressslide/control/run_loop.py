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
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from pushpressslide.control.approach import (
    Approach,
    JointApproach,
    TipApproach,
    TipPath,
    free_tip,
    tip_path,
)
from pushpressslide.control.controller import Controller
from pushpressslide.control.estimator import (
    Estimator,
    ObjectEstimator,
    StampedPose,
)
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.limits import ArmReading, Guard
from pushpressslide.control.plant import Plant
from pushpressslide.control.recording import Recorder, Tick
from pushpressslide.control.recovery import RECOVERABLE, planned_anew, restart
from pushpressslide.control.sensing import Sensor
from pushpressslide.control.state import ControllerState, findings, tip_position
from pushpressslide.control.stopping import JointWatch, Stop, StopLevel
from pushpressslide.control.tracker import ObjectTracker
from pushpressslide.control.watches import Watch
from pushpressslide.core import margins
from pushpressslide.core.control import (
    Commands,
    ControlLog,
    JointCommand,
    Measurement,
    Phase,
    TipCommand,
    TipCommands,
)
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Restart
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
    # the laws, where an experiment changes them
    execution: Execution = USUAL
    # makes what estimates pose and figures of the object, from what was asked for
    estimator: Callable[[MotionQuery], Estimator] = ObjectEstimator
    # sees the object in place of the plant's own sensor, which goes on to feel the tips
    tracker: ObjectTracker | None = None
    # that the run goes on from; None: the task's start, with the arms before the object
    begin: WorldState | None = None


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
    loop = RunLoop(plant, plan, options, watches)
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
        self,
        plant: Plant,
        plan: Plan,
        options: RunOptions | None = None,
        watches: Sequence[Watch] = (),
    ) -> None:
        """Put the first placement before ``plant``; nothing has moved yet."""
        options = options or RunOptions()
        query = plan.query
        period = query.motion.control_period
        self.plan = plan
        self.plant = plant
        self.options = options
        self.time_limit = query.limits.time
        self.recoveries = query.motion.recoveries  # left
        self.events: list[dict[str, Any]] = []  # what was recovered from
        # plans that others took the place of, and how many placements were begun of each
        self.earlier: list[tuple[Plan, int]] = []
        self.sensor = Sensor(query.sensing, options.seed, period)
        self.tracked = StampedPose(plant.time, query.start)  # as last seen by a tracker
        goes_on = options.begin is not None
        self.guard = Guard(
            query.limits.normal_force, period, plant.arm_limits, anew=goes_on
        )
        self.joint_watches = [
            JointWatch(limits.velocity.tolist()) for limits in plant.arm_limits
        ]
        self.breach: Ending | None = None  # the limit that was broken
        self.stopping: Stop | None = None  # since then
        self.recorder = Recorder(plan)
        self.watches = (self._finished, *watches, self._diverged, self._stopped)
        self.ticks = 0
        self.expected = plant.overhead + plan.duration
        self.placements = plan.by_placement
        self.number = 0  # of the present placement
        self.state: ControllerState | None = None  # None before the touch
        before = plant.measure() if goes_on else None
        self._begin((None,) * len(query.scene.robots), plant.time, before)

    def run(self) -> Record:
        """Step to the end and return the record."""
        started = perf_counter()
        ending = None
        while ending is None:
            ending = self.step()
        return self.record(ending, perf_counter() - started)

    def step(self) -> Ending | None:
        """Pass one control period: measure, decide, guard, apply, advance, record.

        Returns why the run is over, None while it goes on. After a recovery the tick
        is the last one before the new approach.
        """
        if self.plant.time >= self.time_limit:
            text = f"limits.time of {self.time_limit:g} s is over"
            return Ending("time_limit", text)
        tick, measurement = self._tick()
        self.recorder.add(tick)
        if self._placement_done() and self.number + 1 < len(self.placements):
            self._hand_over(tick, measurement)
        ended = self._ending(tick)
        if ended is not None and not self._recovers(ended, tick, measurement):
            return ended
        self._report(tick.truth.time)
        return None

    def record(self, ending: Ending, wall_time: float = 0.0) -> Record:
        """Return the record of all steps so far, which took ``wall_time`` [s]."""
        arrays = self.recorder.arrays()
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
            {**self.plant.meta, **self._own_laws(), "events": self.events},
        )

    def _own_laws(self) -> dict[str, str]:
        """What a record says of laws that an experiment changed; else nothing."""
        changed = self.options.execution.changed
        return {} if changed is None else {"execution": changed}

    def _tick(self) -> tuple[Tick, Measurement]:
        """Pass one control period; return what came of it, and what was measured."""
        began = perf_counter()
        truth = self.plant.measure()
        measurement = self._measured(truth)
        followed = self.state.following.reference if self.state is not None else None
        readings = self.plant.readings()
        runaways = self._runaways(readings)
        commands, log = self._decide(measurement)
        applied = self._disturbed(truth.time, commands, log)
        if self.breach is None:
            breach = _runaway(runaways) or self._judged(measurement, readings, applied)
            if breach is not None:
                self._stop(breach, measurement, log.phase)
                commands, log = self._decide(measurement)
        if self.stopping is not None:
            time = truth.time
            applied = self.stopping.step(time, readings, runaways, commands)
            commands = applied
        self.plant.apply(applied)
        total = perf_counter() - began
        self.plant.advance()
        wall_times = (*log.wall_times, total)
        tick = Tick(truth, commands, log, followed, self.plant.row(), wall_times)
        return tick, measurement

    def _measured(self, truth: Measurement) -> Measurement:
        """What the sensors make of a measurement, and a tracker, if there is one."""
        measurement = self.sensor.measure(truth)
        tracker = self.options.tracker
        if tracker is None:
            return measurement
        pose = tracker.read()
        if pose is not None:
            self.tracked = pose
        return replace(
            measurement,
            object_pose=self.tracked.X_WG,
            pose_seen=pose is not None,
            pose_time=self.tracked.time,
        )

    def _decide(self, measurement: Measurement) -> tuple[Commands, ControlLog]:
        if measurement.time < self.approach.arrival:
            return self.approach.step(measurement.time)
        if self.state is None:
            self.state = self.controller.init(measurement, self.approach.held)
        if self.state.phase.name == "release" and self.guard.cramped(
            self.plant.readings()
        ):
            self.state = self.controller.halted(self.state, measurement)
        commands, log, self.state = self.controller.step(self.state, measurement)
        return commands, log

    def _runaways(self, readings: Sequence[ArmReading]) -> list[str | None]:
        """What the joints of each arm do that nothing asked for."""
        watched = zip(self.joint_watches, readings, strict=True)
        return [watch.step(reading.v.tolist()) for watch, reading in watched]

    def _judged(
        self,
        measurement: Measurement,
        readings: Sequence[ArmReading],
        commands: Commands,
    ) -> Ending | None:
        """Return the limit that is broken at this tick."""
        if self.state is None:
            forces = [math.hypot(*tip.force) for tip in measurement.tips]
        else:
            forces = self.controller.normal_forces(self.state, measurement)
        return self.guard.breach(forces, readings, commands)

    def _stop(self, breach: Ending, measurement: Measurement, phase: Phase) -> None:
        """Stop safely because of a ``breach`` in a ``phase``: slow down, then draw back
        or, where nothing else carries the object, hold it.
        """
        time = measurement.time
        text = f"{breach.text} (at {time:.2f} s, {phase})"
        self.breach = Ending(breach.code, text)
        self.stopping = Stop(self.plant.arm_limits, time, self.guard.period)
        if self.state is None:
            self.approach.halt(time)
        else:
            failure = (breach.code, text)
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
        query = placement.query
        paths = self.plant.joint_paths
        gap = before_contacts(query.scene, query.motion, placement.contacts)
        back = min((path.room for path in paths), default=math.inf)
        if paths:  # what the approach really leaves
            self.approach: Approach = JointApproach(query.start, paths, held, time)
            gap = min(gap, *(path.gap for path in paths))
        else:
            travel = tip_paths(placement, held, measurement)
            self.approach = TipApproach(query.start, travel, held, time)
        self.controller = Controller(
            self.plan,
            self.number,
            gap,
            back,
            self.options.execution,
            self.options.estimator,
        )
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
        self.guard.begin()
        self._begin(held, tick.truth.time, measurement)
        self.recorder.begin(self.plan, self.number)

    def _recovers(self, ending: Ending, tick: Tick, measurement: Measurement) -> bool:
        """Plan anew what is left, from where object and arms are, and begin it; return
        whether that can be done, and in time.

        The arms hold meanwhile, since planning may take seconds of a plant's time. None
        is planned from an arm that did not draw back.
        """
        gave_up = self.stopping is not None and self.stopping.took_over
        if self.recoveries == 0 or gave_up:
            return False
        pose = measurement.object_pose
        if self.state is not None:
            pose = self.controller.seen(self.state)
        why = self._lacks(self.breach or ending, pose)
        if why is None:
            return False
        time = tick.truth.time
        try:
            begin = self._restart(pose)
            held = self._hold(tick.truth)
            plan = planned_anew(self.plan, begin, self.plant.prepare)
            self._check_in_time(plan)
        except InfeasibleTaskError as error:
            self._note(time, why, str(error))
            return False
        self._note(time, why)
        self._resume(plan, held)
        return True

    def _lacks(self, ending: Ending, pose: Pose2) -> Ending | None:
        """Return what went wrong, if arms that have drawn back could begin anew."""
        if ending.code == "goal_reached":
            return self.controller.missed(pose)
        return ending if ending.code in RECOVERABLE else None

    def _restart(self, pose: Pose2) -> Restart:
        """Where the task goes on with the object at ``pose``, X_WG.

        Raises InfeasibleTaskError where the arms cannot let go of it.
        """
        scene = self.plan.task.scene
        segment = self.controller.segments[0]
        found = NOTHING
        if self.state is not None:
            segment = self.state.following.segment
            found = findings(self.state)
        elif any(self.approach.held):
            raise InfeasibleTaskError("one arm still holds the object")
        if not scene.carried(pose):
            raise InfeasibleTaskError("nothing but the arms carries the object")
        return restart(scene, segment, pose, found)

    def _hold(self, truth: Measurement) -> Commands:
        """Command all arms, or tips without arms, to stay where they are; return the
        commands.
        """
        readings = self.plant.readings()
        held: Commands = tuple(
            JointCommand(reading.q, np.zeros_like(reading.q)) for reading in readings
        )
        if not readings:
            held = tuple(free_tip(tip.position, (0.0, 0.0, 0.0)) for tip in truth.tips)
        self.plant.apply(held)
        return held

    def _check_in_time(self, plan: Plan) -> None:
        """Raise InfeasibleTaskError where ``plan``, begun now, does not end in time."""
        needed = plan.duration + margins.ARM.regrasp * len(plan.placements)
        left = self.time_limit - self.plant.time
        if needed > left:
            raise InfeasibleTaskError(
                f"another attempt takes {needed:.0f} s; limits.time leaves {left:.0f} s"
            )

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

    def _resume(self, plan: Plan, held: Commands) -> None:
        """Begin ``plan`` in place of the rest of the present one, now: planning has
        taken what it has of the plant's time, under the commands ``held``.
        """
        measurement = self.plant.measure()
        time = measurement.time
        self.earlier.append((self.plan, self.number + 1))
        self.plan = plan
        self.placements = plan.by_placement
        self.number = 0
        self.recoveries -= 1
        self.breach = None
        self.stopping = None
        self.guard = self.guard.successor(plan.task.limits.normal_force, held)
        self.expected = time + margins.ARM.regrasp + plan.duration
        self.plant.hand_over(self.placements[0], frozenset())
        self._begin((None,) * len(plan.task.robots), time, measurement)
        self.recorder.begin(plan, 0)

    def _placement_done(self) -> bool:
        state = self.state
        return (
            state is not None
            and state.phase.name == "done"
            and state.phase.failure is None
        )

    def _ending(self, tick: Tick) -> Ending | None:
        """Return the first ending that a watch finds."""
        for watch in self.watches:
            ending = watch(tick)
            if ending is not None:
                return ending
        return None

    def _finished(self, tick: Tick) -> Ending | None:
        stopping = self.stopping
        if stopping is not None and stopping.took_over:
            return self._stopped_short(stopping, tick.truth.time)
        if self.state is None:
            return self.breach if self.approach.at_rest(tick.truth.time) else None
        if self.state.phase.name != "done":
            return None
        failure = self.state.phase.failure
        return Ending("goal_reached") if failure is None else Ending(*failure)

    def _stopped_short(self, stopping: Stop, time: float) -> Ending | None:
        """How a run ends whose arms did not draw back, once they rest at ``time`` [s]."""
        assert self.breach is not None
        if not stopping.at_rest(time):
            return None
        if self.breach.code != "runaway":
            braked = StopLevel.BRAKE in stopping.levels
            then = "ran away" if braked else "did not draw back"
            text = f"{self.breach.text}; then an arm {then}"
            self.breach = Ending(self.breach.code, text)
        return self.breach

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


def _runaway(runaways: Sequence[str | None]) -> Ending | None:
    """Ending of a run in which an arm's joints run away, from what each arm's do."""
    for arm, text in enumerate(runaways):
        if text is not None:
            return Ending("runaway", f"arm {arm} runs away: {text}")
    return None


def tip_paths(
    placement: Plan, held: TipCommands, measurement: Measurement | None
) -> list[TipPath | None]:
    """Return the way of each tip without an arm, over the object: to before its planned
    contact, or to its robot's base, where a tip waits that has none. None for one that
    holds its contact, and at the start of a run.
    """
    query = placement.query
    scene = query.scene
    paths: list[TipPath | None] = [None] * len(scene.robots)
    if measurement is None:
        return paths
    X_WB = query.start.compose(query.X_GB)
    gap = before_contacts(query.scene, query.motion, placement.contacts)
    ends = {
        contact.arm: tip_position(
            contact, X_WB, scene.robots[contact.arm].tip_radius, gap
        )
        for contact in placement.contacts
    }
    for arm, (robot, base) in enumerate(zip(scene.robots, scene.bases, strict=True)):
        begin = measurement.tips[arm].position
        waits = arm not in ends and math.dist(begin, base) < AT_BASE
        if held[arm] is None and not waits:
            above = scene.body.shape.height + robot.tip_radius + gap
            paths[arm] = tip_path(begin, ends.get(arm, base), above)
    return paths
