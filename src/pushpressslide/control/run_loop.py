"""The run loop: it runs one plan on any plant.

Every tick measures, decides, applies, advances and records. Commands come from the
approach while the arms move freely, then from the controller. When a placement is done
the next one is handed over. The controller, the watches, the plant, the user or the
time limit end the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

from pushpressslide.control.approach import JointApproach
from pushpressslide.control.controller import Controller
from pushpressslide.control.plant import Plant
from pushpressslide.control.recording import Recorder, Tick
from pushpressslide.control.sensing import Sensor
from pushpressslide.control.state import ControllerState
from pushpressslide.control.watches import Watch
from pushpressslide.core.control import (
    Commands,
    ControlLog,
    Measurement,
    TipCommand,
    TipCommands,
)
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Ending, Record

PROGRESS_TICKS = 25  # between two reports of the progress


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What a caller may ask of a run on any plant."""

    seed: int = 0  # of the sensor noise
    # called with time and expected duration [s] every PROGRESS_TICKS
    progress: Callable[[float, float], None] | None = None
    # asked at every tick whether to end the run with reason "interrupted"
    stop: Callable[[], bool] = bool
    # changes the controller's commands at a time [s] on their way to the arms; the
    # record keeps the commands as given
    disturb: Callable[[float, Commands], Commands] | None = None


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
    return _RunLoop(plant, plan, options or RunOptions(), watches).run()


class _RunLoop:
    """One run: the present placement, what is ahead, and what ends it."""

    def __init__(
        self, plant: Plant, plan: Plan, options: RunOptions, watches: Sequence[Watch]
    ) -> None:
        task = plan.part(plan.segments[0])
        self.plan = plan
        self.plant = plant
        self.options = options
        self.time_limit = task.limits.time
        self.sensor = Sensor(task.sensing, options.seed, task.motion.control_period)
        self.recorder = Recorder(plan)
        self.watches = (self._finished, *watches, self._diverged, self._stopped)
        self.ticks = 0
        self.expected = plant.overhead + plan.duration
        self.placements = plan.by_placement
        self.number = 0  # of the present placement
        self.state: ControllerState | None = None  # None before the touch
        self._begin((None,) * len(task.robots), plant.time)

    def run(self) -> Record:
        """Go through all ticks and return the record."""
        started = perf_counter()
        ending = Ending("time_limit", f"limits.time of {self.time_limit:g} s is over")
        while self.plant.time < self.time_limit:
            tick = self._tick()
            self.recorder.add(tick)
            if self._placement_done() and self.number + 1 < len(self.placements):
                self._hand_over(tick)
            ended = self._ending(tick)
            if ended is not None:
                ending = ended
                break
            self._report(tick.truth.time)
        wall_time = perf_counter() - started
        return self.recorder.record(
            ending, self.plant.name, self.options.seed, wall_time, self.plant.meta
        )

    def _tick(self) -> Tick:
        began = perf_counter()
        truth = self.plant.measure()
        followed = self.state.reference if self.state is not None else None
        commands, log = self._decide(truth)
        self.plant.apply(self._disturbed(truth.time, commands, log))
        total = perf_counter() - began
        self.plant.advance()
        decided = self.state.ticks if self.state is not None else (0.0, 0.0)
        wall_times = (*decided, total)
        return Tick(truth, commands, log, followed, self.plant.row(), wall_times)

    def _decide(self, truth: Measurement) -> tuple[Commands, ControlLog]:
        if truth.time < self.approach.arrival:
            return self.approach.step(truth.time)
        measurement = self.sensor.measure(truth)
        if self.state is None:
            self.state = self.controller.init(measurement, self.approach.held)
        commands, log, self.state = self.controller.step(self.state, measurement)
        return commands, log

    def _disturbed(self, time: float, commands: Commands, log: ControlLog) -> Commands:
        disturb = self.options.disturb
        if disturb is None or log.phase == "approach":
            return commands
        return disturb(time, commands)

    def _begin(self, held: TipCommands, time: float) -> None:
        """Begin the present placement at ``time`` [s]."""
        task = self.placements[self.number].task
        paths = self.plant.joint_paths
        self.approach = JointApproach(task.start, paths, held, time)
        gap = None
        if paths:  # what the approach really leaves
            planned = task.motion.approach_distance
            gap = min(planned, *(path.gap for path in paths))
        self.controller = Controller(self.plan, self.number, gap)
        self.state = None

    def _hand_over(self, tick: Tick) -> None:
        """Begin the next placement; arms that keep their contact go on as commanded."""
        lasting = self.controller.lasting
        held = tuple(
            command if i in lasting and isinstance(command, TipCommand) else None
            for i, command in enumerate(tick.commands)
        )
        self.number += 1
        self.plant.hand_over(self.placements[self.number], lasting)
        self._begin(held, tick.truth.time)
        self.recorder.begin(self.number)

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
        if self.state is None or self.state.phase != "done":
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
