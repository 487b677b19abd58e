"""The run loop: runs one plan in any cell.

Commands come from the approach while the arms move freely, then from the controller.
When a placement is done, the next one starts. A guard checks every command before it is
sent; if a limit is broken, the arms stop safely. The controller, the guard, the
watches, the clock, the user or the time limit end the run.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from pushpressslide.control.approach import (
    Approach,
    JointApproach,
    TipApproach,
    TipPath,
    free_tip,
    tip_path,
)
from pushpressslide.control.cell import Applied, Cell, TrueState
from pushpressslide.control.center_belief import CenterBelief, beside_center
from pushpressslide.control.controller import Controller
from pushpressslide.control.estimator import Estimator, ObjectEstimator
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.hand_eye import HandEye
from pushpressslide.control.identified import Identified
from pushpressslide.control.joint_pace import joint_pace
from pushpressslide.control.last_look import LastLook
from pushpressslide.control.limits import ArmReading, Guard
from pushpressslide.control.looking import RestingPose
from pushpressslide.control.placement import leads_on, share_of_tolerance
from pushpressslide.control.pressed_body import PressedBody, PressedFit
from pushpressslide.control.recording import Recorder, Tick
from pushpressslide.control.recovery import (
    OF_ARMS,
    RECOVERABLE,
    after_force_limit,
    after_slides,
    planned_anew,
    planned_otherwise,
    restart,
)
from pushpressslide.control.sensing import sensed
from pushpressslide.control.spacing import SpacingWatch
from pushpressslide.control.state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    ControllerState,
    estimates,
    tip_position,
)
from pushpressslide.control.stopping import JointWatch, Stop, StopLevel, own_rates
from pushpressslide.control.supervisor import Moment, Settled
from pushpressslide.control.tare import Tare
from pushpressslide.control.tracker import ObjectTracker, StampedPose
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
    TipState,
)
from pushpressslide.core.errors import InfeasibleTaskError, Shown, TaskError
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Restart
from pushpressslide.core.truth import EXACT, refuse_truth
from pushpressslide.identification.parameter_estimates import NOTHING
from pushpressslide.identification.pressed_travel import PressedTravel
from pushpressslide.identification.tip_friction import TipFriction
from pushpressslide.planning.side_contacts import before_contacts
from pushpressslide.selection.placement_planner import FailedPlacement

# share of the goal's tolerances by which a placement moves an object that is stuck
STUCK = 0.5
AT_BASE = 0.01  # [m] from its robot's base at which a tip without an arm waits
T = TypeVar("T")
PROGRESS_TICKS = 25  # ticks between two progress reports
TOUCH_AND_RELEASE = 4.0  # [s] typical duration of both, for the progress


@dataclass(frozen=True, slots=True)
class RunOptions:
    """Options of a run in any cell."""

    seed: int = 0  # of the sensor noise
    # called every PROGRESS_TICKS with the time and the expected duration [s]
    progress: Callable[[float, float], None] | None = None
    # called at every tick; True ends the run with reason "interrupted"
    stop: Callable[[], bool] = bool
    # changes the controller's commands at a time [s] before the guard and the arms get
    # them, until a limit is broken; the record keeps the original commands
    disturb: Callable[[float, Commands], Commands] | None = None
    # the control laws, for experiments
    execution: Execution = USUAL
    # of each placement
    controller: type[Controller] = Controller
    # makes the estimator of the object's pose and parameters from the motion query
    estimator: Callable[[MotionQuery], Estimator] = ObjectEstimator
    # replaces the engine's object tracker
    tracker: Callable[[ObjectTracker], ObjectTracker] | None = None
    # from which the run continues; None: the task's start, with the arms at the object
    begin: WorldState | None = None
    # of what the task's truth has drawn of the world; None: that of the sensor noise
    world_seed: int | None = None

    @property
    def true_world_seed(self) -> int:
        """Seed of the true world."""
        return self.seed if self.world_seed is None else self.world_seed


def run_loop(
    cell: Cell,
    plan: Plan,
    options: RunOptions | None = None,
    watches: Sequence[Watch] = (),
) -> Record:
    """Run ``plan`` in a cell from its start, and return the record.

    Nothing is decided by wall time: a deterministic simulator gives the same record for
    the same seed.
    """
    with cell.connected(), _uncollected():
        return RunLoop(cell, plan, options, watches).run()


@contextmanager
def _uncollected() -> Iterator[None]:
    """Context without Python's cyclic garbage collection.

    The collection would delay one tick of each run by 0.1 s, and a run leaves no cycles
    worth collecting.
    """
    collected = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collected:
            gc.enable()


class RunLoop:
    """One run: the present placement, the remaining ones, and the conditions that end
    it.

    The caller connects the arms: ``with cell.connected()``.
    """

    def __init__(
        self,
        cell: Cell,
        plan: Plan,
        options: RunOptions | None = None,
        watches: Sequence[Watch] = (),
    ) -> None:
        """Load the first placement into ``cell``. Nothing has moved yet."""
        options = options or RunOptions()
        query = plan.query
        period = query.motion.control_period
        arms = len(query.scene.robots)
        if plan.task.disturbances and not cell.clock.simulated:
            source = plan.task.source or plan.task.name
            count = len(plan.task.disturbances)
            allowed = f"allowed on a robot: []; a {cell.name} has no knocks"
            raise TaskError(source, "disturbances", Shown(f"{count} knocks"), allowed)
        if cell.clock.simulated:
            cell = sensed(cell, query.sensing, options.seed, period)
        else:
            source = plan.task.source or plan.task.name
            refuse_truth(plan.task.truth, EXACT, source, "with real arms")
        self.plan = plan
        self.before = plan.task  # as believed before the run
        self.believed = plan.task.scene  # the same
        self.cell = cell
        self.tracker = cell.tracker
        if options.tracker is not None:
            self.tracker = options.tracker(cell.tracker)
        self.options = options
        self.time_limit = query.limits.time
        self.recoveries = query.motion.recoveries  # left
        self.events: list[dict[str, Any]] = []  # recoveries so far
        # replaced plans, each with its number of started placements
        self.earlier: list[tuple[Plan, int]] = []
        self.tracked = StampedPose(cell.clock.time, query.start)  # last measurement
        goes_on = options.begin is not None
        limits = self.arm_limits = cell.arm_limits
        noise = query.sensing.force_noise
        force = query.limits.normal_force
        self.guard = Guard(force, period, limits, goes_on, noise)
        self.joint_watches = [JointWatch(each.velocity.tolist()) for each in limits]
        self.spacing = None if cell.spacing is None else SpacingWatch(cell.spacing)
        self.breach: Ending | None = None  # broken limit
        self.breaches: list[dict[str, Any]] = []  # all of them, with their times [s]
        self.stopping: Stop | None = None  # since then
        self.recorder = Recorder(plan)
        self.tare = Tare(arms)
        self.resting = RestingPose()  # of the object, during an approach
        self.watches = (self._finished, *watches, self._failed, self._stopped)
        self.last_look: LastLook | None = None  # None: not needed
        self.identified = Identified()  # in the placements before this one
        self.center: CenterBelief | None = None  # the same; None: it is sure
        if self.believed.center_error > 0.0:
            self.center = CenterBelief.before_run(self.believed)
        # under single presses, before this placement; ``center`` is without them
        self.travels: tuple[PressedTravel, ...] = ()
        self.pressed_fit = PressedFit(self.believed, noise)
        self.hand_eyes: dict[int, HandEye] = {}  # by arm, as seen before
        self.lost: list[FailedPlacement] = []  # whose contacts were lost before
        self.failed: list[FailedPlacement] = []  # which are not repeated
        self.least_friction = 0.0  # of the support, which has withstood the tips
        self.tip_friction: TipFriction | None = None  # of presses that have slid
        self.pose_at_touch = query.start  # X_WG, of the present placement
        self.looked_on: float | None = None  # [s] since when for longer
        self.ticks = 0
        self.placements = plan.by_placement
        self.number = 0  # of the present placement
        self.state: ControllerState | None = None  # None before the touch
        self.event: Settled | Moment | None = None  # of this tick
        self.holding: Commands | None = None  # commands during planning
        self.log: ControlLog  # of the last tick
        before = self.measure()[0] if goes_on else None
        self._begin_placement((None,) * arms, cell.clock.time, before)

    def run(self) -> Record:
        """Step to the end and return the record."""
        started = perf_counter()
        ending = None
        while ending is None:
            ending = self.step()
        return self.record(ending, perf_counter() - started)

    def step(self) -> Ending | None:
        """Run one control period: measure, decide, guard, send, advance, record.

        Returns the reason why the run is over, or None while it continues. After a
        recovery, ``tick`` is the last tick before the new approach.
        """
        if self.cell.clock.time >= self.time_limit:
            text = f"limits.time of {self.time_limit:g} s is over"
            return Ending("time_limit", text)
        tick, measurement = self._tick()
        self.recorder.add(tick)
        more = self.number + 1 < len(self.placements)
        if more and self._placement_done() and not self._plans_rest(tick, measurement):
            self._hand_over(tick, measurement)
        ended = self._ending(tick)
        if ended is not None:
            if self.looked_on is None:
                self.looked_on = tick.time
            may_look = self._may_look(tick.time, self.looked_on)
            verified = self._verified(ended, may_look)
            looks_on = may_look and verified.code == "not_verified"
            if not looks_on and not self._recovers(ended, verified, tick, measurement):
                return verified
        self._report(tick.time)
        return None

    def record(self, ending: Ending, wall_time: float = 0.0) -> Record:
        """Record of all steps so far, which took ``wall_time`` [s]."""
        self._learn()
        arrays = self.recorder.arrays()
        plan = self.plan
        for earlier, count in reversed(self.earlier):
            plan = earlier.begun(count, plan)
        witness = self.cell.witness
        facts = {} if witness is None else witness.facts
        return self.recorder.record(
            arrays,
            self.breach or ending,
            self.cell.name,
            self.options.seed,
            wall_time,
            plan,
            {
                **facts,
                **self._own_laws(),
                **self._knowledge(),
                **self.identified.figures,
                "events": self.events,
                "breaches": self.breaches,
            },
        )

    def measure(self) -> tuple[Measurement, list[ArmReading]]:
        """Measurements of tracker and arms, and readings of the arms' joints."""
        time = self.cell.clock.time
        states = [arm.read() for arm in self.cell.arms]
        pose = self.tracker.read()
        if pose is not None and not pose.is_finite:
            pose = None
        if pose is not None:
            self.tracked = pose
        measured = self.tracked
        self.raw = [state.tip for state in states]
        tips = self.tare.removed(self.raw)
        joints = [state.joints for state in states if state.joints is not None]
        measurement = Measurement(
            time, measured.X_WG, tips, pose is not None, measured.time
        )
        return measurement, joints

    @property
    def approaching(self) -> bool:
        """Whether the arms are still approaching the touch."""
        return self.cell.clock.time < self.approach.arrival

    def drive(self, commands: Commands) -> Measurement:
        """Run one control period under external ``commands``, neither guarded nor
        recorded. Returns the measurements at its end.
        """
        self._send(commands)
        self.cell.clock.advance()
        measurement, _ = self.measure()
        return measurement

    def _own_laws(self) -> dict[str, str]:
        """Note on changed laws, for the record. Empty if none is changed."""
        options = self.options
        own: dict[str, str] = {}
        if options.execution.changed is not None:
            own["execution"] = options.execution.changed
        if options.controller is not Controller:
            own["controller"] = options.controller.__name__
        return own

    def _learn(self) -> None:
        """Add what the present placement has identified."""
        if self.state is not None:
            self.identified = self.identified.better(self._identified_now(self.state))
            self.center = self._told_center()
            self.travels = self._travels_now()
            seen = None
            if isinstance(self.controller, Controller):
                seen = self.controller.seen_tip(self.state)
            if seen is not None:
                arm, hand_eye = seen
                self.hand_eyes[arm] = hand_eye
            elif self._touch_failed:
                for contact in self.controller.segments[0].contacts:
                    self.hand_eyes.pop(contact.arm, None)

    def _learn_as_it_ends(self, before: ControllerState | None) -> None:
        """Learn from the state ``before``, if the tips are let go after it."""
        if before is None or self.state is None:
            return
        if self.state.phase.name == "release":
            self._learn_friction(before)

    def _learn_friction(self, state: ControllerState) -> None:
        """Learn the friction of a support that has withstood the tips: where the object
        stands still, and is not known exactly.
        """
        pose = self.controller.filtered_pose(state)
        if self._moves_object(pose) or not self.believed.planned_for_errors:
            return
        least = self.controller.withstood_friction(state)
        self.least_friction = max(self.least_friction, least)

    def _dragged_friction(self) -> float | None:
        """Support friction, with the believed mass, that pushes have identified. None if
        it does not contradict the belief.
        """
        found = self.identified
        if self.state is not None:
            found = found.better(self._identified_now(self.state))
        product = found.parameters.get("mass_times_friction")
        if product is None or not product.contradicts_belief:
            return None
        return product.value / self.believed.body.mass

    def _known_center(self) -> CenterBelief | None:
        """What is believed of the centre of mass after the present placement. None if
        it is sure.
        """
        body = self._pressed_body()
        return self._told_center() if body is None else body.center

    def _told_center(self) -> CenterBelief | None:
        """The same without what the turns under presses have told."""
        if self.center is None or self.state is None:
            return self.center
        travels = self._travels_now()
        if len(travels) > len(self.travels):
            return self.center
        found = self._identified_now(self.state).parameters
        return self.center.knowing(found.get("center_of_mass"))

    def _travels_now(self) -> tuple[PressedTravel, ...]:
        """Travels under single presses up to now, where they did not slide."""
        own = isinstance(self.controller, Controller)
        if not own or self.state is None or self._presses_slid:
            return self.travels
        return (*self.travels, *self.controller.pressed_travels(self.state))

    def _pressed_body(self) -> PressedBody | None:
        """What the turns under presses have told of the object. None if nothing."""
        return self.pressed_fit.body(self._told_center(), self._travels_now())

    def _identified_now(self, state: ControllerState) -> Identified:
        """What the present placement has identified: no centre of mass from presses that
        slid.
        """
        found = self.controller.identified(state, self.believed)
        if "center_of_mass" in found.parameters and self._presses_slid:
            return found.without("center_of_mass")
        return found

    def _knowledge(self) -> dict[str, Any]:
        """Note on what is known of the final pose, for the record: that only
        measurements are, and the last look. Empty if every pose is exact.
        """
        out: dict[str, Any] = {}
        if self.cell.witness is None and not self.cell.clock.simulated:
            out["measured_only"] = True
        if self.last_look is not None:
            X = self.last_look.X_WG
            pose = [X.x, X.y, X.yaw]
            out["last_look"] = {"pose": pose, "spread": [*self.last_look.spread]}
        return out

    def _tick(self) -> tuple[Tick, Measurement]:
        """Run one control period. Returns the tick and its measurements."""
        began = perf_counter()
        measurement, readings = self.measure()
        read = perf_counter()
        time = measurement.time
        followed = self.state.following.reference if self.state is not None else None
        runaways = self._runaways(readings)
        commands, log = self._decide(measurement, readings)
        sent = self._disturbed(time, commands, log)
        if self.breach is None:
            breach = _runaway(runaways) or self._after_tick(measurement, readings, sent)
            if breach is not None:
                self._stop(breach, measurement, log.phase)
                commands, log = self._decide(measurement, readings)
        if self.stopping is not None:
            self._hold_if_near(time, readings)
            sent = self.stopping.step(time, readings, runaways, commands)
            commands = sent
        decided = perf_counter()
        applied = self._send(sent)
        execution = read - began + perf_counter() - decided
        self.log = log
        self._supervise(commands, measurement)
        ended = perf_counter()
        self.cell.clock.advance()
        wall_times = (*log.wall_times, execution, ended - began)
        truth = self._truth(measurement)
        joints = tuple(zip(readings, applied, strict=False))
        tick = Tick(time, truth, commands, log, followed, joints, wall_times)
        return tick, measurement

    def _send(self, commands: Commands) -> list[Applied]:
        """Send a command to every arm. Returns what was really applied."""
        arms = zip(self.cell.arms, commands, strict=True)
        return [arm.send(command) for arm, command in arms]

    def _truth(self, measurement: Measurement) -> TrueState:
        """State of the completed tick for the record: the true state if there is a
        witness, otherwise the measured state.
        """
        witness = self.cell.witness
        if witness is not None:
            return witness.observe()
        return TrueState(measurement.object_pose, measurement.tips)

    def _decide(
        self, measurement: Measurement, readings: Sequence[ArmReading]
    ) -> tuple[Commands, ControlLog]:
        if self.holding is not None:
            return self.holding, self.log
        if measurement.time < self.approach.arrival:
            self._learn_at_rest(measurement)
            return self.approach.step(measurement.time)
        if self.state is not None:
            untouched = self.controller.untouched(self.state)
            if untouched:
                self.tare.add(self.raw, [i in untouched for i in range(len(self.raw))])
        if self.state is None:
            looked = self._looked(measurement)
            self.pose_at_touch = looked.object_pose
            self.state = self.controller.init(looked, self.approach.held)
        if self.state.phase.name == "release" and self.guard.near_joint_limit(readings):
            self.state = self.controller.halted(self.state, measurement)
        step = self.controller.step(self.state, measurement)
        self.state = step.state
        self.event = step.event
        return step.commands, step.log

    def _learn_at_rest(self, measurement: Measurement) -> None:
        """Learn the object's pose and the zeros of the forces from a tick of the
        approach.
        """
        self.tare.add(self.raw, [command is None for command in self.approach.held])
        if measurement.pose_seen:
            self.resting.add(self.tracked)

    def _looked(self, measurement: Measurement) -> Measurement:
        """The measurement with the pose from all pictures of the approach, unless every
        picture is right.
        """
        if self.plan.task.sensing.every_pose:
            return measurement
        middle = self.resting.middle(self.tracked)
        return replace(measurement, object_pose=middle.X_WG, pictures=middle.pictures)

    def _supervise(self, commands: Commands, measurement: Measurement) -> None:
        """Decide on the event of this tick, if there is one. ``commands`` are those
        that the arms execute.
        """
        event = self.event
        if event is None:
            return
        self.event = None
        supervisor = self.controller.supervisor
        before = self.state
        if self.cell.clock.simulated or not supervisor.plans(event):
            self.state = supervisor.step(event)
            self._learn_as_it_ends(before)
            return
        held_commands = still(commands, measurement.tips)
        state = self._while_holding(partial(supervisor.step, event), held_commands)
        if self.stopping is None:  # otherwise the stop continues
            passed = self.cell.clock.time - event.instant.time
            self.state = state.delayed(passed)
            self._learn_as_it_ends(before)

    def _while_holding(self, plan: Callable[[], T], held_commands: Commands) -> T:
        """Result of ``plan``. If time passes during planning, ``held_commands`` keep
        the arms in position.
        """
        if self.cell.clock.simulated:
            return plan()
        self.holding = held_commands
        pool = ThreadPoolExecutor(1)
        planned = pool.submit(plan)
        pool.shutdown(wait=False)
        while not planned.done():
            tick, _ = self._tick()
            self.recorder.add(tick)
            self._report(tick.time)
        self.holding = None
        return planned.result()

    def _runaways(self, readings: Sequence[ArmReading]) -> list[str | None]:
        """Description of uncommanded joint motion of each arm. None for an arm without
        any.
        """
        arms = zip(self.joint_watches, self.arm_limits, readings, strict=True)
        return [
            watch.step(own_rates(limits, reading)) for watch, limits, reading in arms
        ]

    def _after_tick(
        self,
        measurement: Measurement,
        readings: Sequence[ArmReading],
        commands: Commands,
    ) -> Ending | None:
        """Limit broken at this tick, or None."""
        if self.state is None:
            forces = [math.hypot(*tip.force) for tip in measurement.tips]
        else:
            forces = self.controller.normal_forces(self.state, measurement)
        breach = self.guard.breach(forces, readings, commands)
        return breach or self._approached(measurement.time, readings)

    def _approached(self, time: float, readings: Sequence[ArmReading]) -> Ending | None:
        """Ending of a run whose arms would touch each other, or None. On the approach
        they follow their plan.
        """
        if self.spacing is None or self.state is None:
            return None
        return self.spacing.step(time, [reading.q for reading in readings])

    def _hold_if_near(self, time: float, readings: Sequence[ArmReading]) -> None:
        """Hold arms that draw back from a limit, but towards each other."""
        if self.stopping is None or self.spacing is None:
            return
        self._approached(time, readings)
        if self.spacing.too_near:
            self.stopping.hold()

    def _stop(self, breach: Ending, measurement: Measurement, phase: Phase) -> None:
        """Stop safely because of a ``breach`` in a ``phase``.

        The arms slow down, then draw back, or hold an object that would otherwise fall.
        """
        time = measurement.time
        text = f"{breach.text} (at {time:.2f} s, {phase})"
        self.breach = Ending(breach.code, text)
        self.breaches.append({"time": time, "code": breach.code, "text": text})
        self.stopping = Stop(self.guard.arms, time, self.guard.period)
        self.last_look = None
        if self.state is None:
            self.approach.halt(time)
        else:
            self._learn_friction(self.state)
            failure = (breach.code, text)
            self.state = self.controller.stop(self.state, measurement, failure)
            self.event = None
            self.holding = None

    def _disturbed(self, time: float, commands: Commands, log: ControlLog) -> Commands:
        disturb = self.options.disturb
        stopping = self.breach is not None
        if disturb is None or stopping or log.phase == "approach":
            return commands
        return disturb(time, commands)

    def _begin_placement(
        self, held_commands: TipCommands, time: float, measurement: Measurement | None
    ) -> None:
        """Start the present placement at ``time`` [s], with the tips as measured."""
        placement = self.placements[self.number]
        query = placement.query
        paths = self.cell.joint_paths
        gap = before_contacts(query.scene, query.motion, placement.contacts)
        back = min((path.max_retreat for path in paths), default=math.inf)
        if paths:  # gap that the approach really leaves
            self.approach: Approach = JointApproach(
                query.start, paths, held_commands, time
            )
            gap = min(gap, *(path.gap for path in paths))
        else:
            travel = tip_paths(placement, held_commands, measurement)
            self.approach = TipApproach(query.start, travel, held_commands, time)
        self.controller = self.options.controller(
            self.plan,
            self.number,
            gap,
            back,
            self.options.execution,
            self.options.estimator,
        )
        limits = self.arm_limits
        self.state = None
        own = isinstance(self.controller, Controller)
        if own and paths and len(limits) == len(paths):
            self.controller.keep_pace(joint_pace(paths, limits))
        if own:
            self.controller.know_tips(self.hand_eyes)
            center = self._known_center()
            if center is not None:
                self.controller.know_center(center)
        if own:
            self.controller.supervisor.pressed_body = self._pressed_body
            self.controller.supervisor.gives_up = self.recoveries > 0
        if self.spacing is not None:
            self.spacing.forget()
        self.resting = RestingPose()
        self.expected = self._expected(time)

    def _expected(self, time: float) -> float:
        """Expected end [s] of the run if the present placement starts at ``time``.

        Later approaches are assumed to take as long as the present one.
        """
        ahead = self.placements[self.number :]
        approach = self.approach.arrival - time
        motions = sum(placement.duration for placement in ahead)
        return time + (approach + TOUCH_AND_RELEASE) * len(ahead) + motions

    def _hand_over(self, tick: Tick, measurement: Measurement) -> None:
        """Start the next placement. Arms that keep their contacts repeat their last
        commands.
        """
        kept_arms = self.controller.kept_arms
        held_commands = tuple(
            command if i in kept_arms and isinstance(command, TipCommand) else None
            for i, command in enumerate(tick.commands)
        )
        self._learn()
        self.number += 1
        self.cell.placements.hand_over(self.placements[self.number], kept_arms)
        self.guard.forget_references()
        time = tick.time
        if self.cell.clock.time - time > 2.0 * self.guard.period:  # planned meanwhile
            measurement, _ = self.measure()
            time = measurement.time
        self._begin_placement(held_commands, time, measurement)
        self.recorder.begin_placement(self.plan, self.number)

    def _recovers(
        self, ending: Ending, verified: Ending, tick: Tick, measurement: Measurement
    ) -> bool:
        """Replan the remaining task from the current state and start it. Return False
        if no plan ends in time. ``verified`` is what the last look has shown of the
        ``ending``.

        The arms hold their positions during planning, which may take seconds in a real
        cell. There is no recovery if an arm did not draw back.
        """
        gave_up = self.stopping is not None and self.stopping.took_over
        if self.recoveries == 0 or gave_up:
            return False
        pose = measurement.object_pose
        if self.state is not None:
            pose = self.controller.filtered_pose(self.state)
        reason = self._retriable_ending(self.breach or ending, pose)
        if reason is None and self._may_correct(verified):
            reason = verified
        if reason is None:
            return False
        time = tick.time
        try:
            start = self._restart(pose)
            if reason.code == "force_limit":
                start = after_force_limit(start, self.plan.task.limits)
            self._remember_failure(reason, pose)
            failed = list(self.failed)
            if reason.code in OF_ARMS and self._followed is not None:
                failed.append(FailedPlacement(self._followed, self.controller.X_GB))
            plan, held_commands = self._planned_from(start, tick, measurement, failed)
        except InfeasibleTaskError as error:
            self._note(time, reason, str(error))
            return False
        self._note(time, reason)
        self.looked_on = None
        self.recoveries -= 1
        self._resume(plan, held_commands)
        return True

    def _remember_failure(self, reason: Ending, pose: Pose2) -> None:
        """Remember presses that slid, a placement whose contacts were lost twice, and
        one that left the object, now at ``pose``, X_WG, where it was.
        """
        if self.state is None:
            return
        here = self._failed_here
        if reason.code in ("force_limit", "goal_missed"):
            self._remember_stuck(pose)
        if reason.code != "contact_lost":
            return
        if self._presses_slid:
            self.failed.append(here.anywhere)
        elif any(here.repeated_by(one.segment, one.X_GB) for one in self.lost):
            self.failed.append(here)
        else:
            self.lost.append(here)

    def _remember_stuck(self, pose: Pose2) -> None:
        """Remember a placement that left the object, now at ``pose``, X_WG, where it
        was.
        """
        began = self.state is not None and self.state.following.began is not None
        if began and not self._moves_object(pose):
            self.failed.append(self._failed_here)

    @property
    def _failed_here(self) -> FailedPlacement:
        """The present placement, as one that has failed."""
        return FailedPlacement(self.controller.segments[0], self.controller.X_GB)

    def _moves_object(self, pose: Pose2) -> bool:
        """Whether the placement has moved the object, now at ``pose``, X_WG."""
        tolerance = self.plan.task.tolerance
        return share_of_tolerance(pose, self.pose_at_touch, tolerance) >= STUCK

    @property
    def _slid(self) -> bool:
        """Whether contacts slid in the placement."""
        return self.state is not None and self.state.watches.retouches > 0

    @property
    def _presses_slid(self) -> bool:
        """Whether presses alone slid in the placement."""
        followed = self._followed
        if followed is None or not self._slid:
            return False
        return all(contact.kind == "top" for contact in followed.contacts)

    def _plans_rest(self, tick: Tick, measurement: Measurement) -> bool:
        """Replan the remaining placements, if the next one would push beside the centre
        of mass, or does not lead to its goal from here. Return False if it would not,
        or if there is no other plan.
        """
        if self.state is None or self.controller.kept_arms:
            return False
        after = self.placements[self.number + 1]
        center = self._known_center()
        pose = self.controller.filtered_pose(self.state)
        beside = center is not None and beside_center(after, center)
        if not beside and leads_on(after, pose):
            return False
        leg = after.segments[0].leg
        try:
            self._remember_stuck(pose)
            start = replace(self._restart(pose), leg=leg)
            plan, held_commands = self._planned_from(
                start, tick, measurement, self.failed
            )
        except InfeasibleTaskError:
            self.cell.placements.restore()
            return False
        self._resume(plan, held_commands)
        return True

    @property
    def _touch_failed(self) -> bool:
        """Whether tips have failed to touch the object in the placement."""
        state = self.state
        if state is None or state.phase.failure is None:
            return False
        code, _ = state.phase.failure
        return code == "contact_lost" and state.following.began is None

    @property
    def _followed(self) -> Segment | None:
        """The segment that is followed. None in an approach."""
        return None if self.state is None else self.state.following.binding.segment

    def _planned_from(
        self,
        start: Restart,
        tick: Tick,
        measurement: Measurement,
        failed: Sequence[FailedPlacement],
    ) -> tuple[Plan, Commands]:
        """Plan of the remaining task from ``start``, and the commands that hold the arms
        meanwhile. It begins otherwise than all ``failed`` placements, if it can.

        Raises InfeasibleTaskError if no plan ends in time.
        """
        held_commands = self._hold(tick, measurement)
        prepare = self.cell.placements.prepare
        before = self.before
        make = partial(planned_anew, self.plan, start, prepare, before=before)
        if failed:
            make = partial(
                planned_otherwise, self.plan, start, prepare, failed, before=before
            )
        plan = self._while_holding(make, held_commands)
        self._check_in_time(plan)
        return plan, held_commands

    def _verified(self, ending: Ending, may_look: bool) -> Ending:
        """The ``ending``, or what the last look shows of a goal that should be reached,
        unless every pose is exact. It is surer if it ``may_look`` on.
        """
        task = self.plan.task
        exact = task.sensing.exact_pose
        if ending.code != "goal_reached" or exact or self.state is None:
            return ending
        look = self.controller.last_look(self.state)
        self.last_look = look
        if task.tool is not None:
            return Ending("not_verified", f"{task.tool.body!r} is not looked at")
        doubt = margins.EARLY_DOUBT if may_look else margins.DOUBT
        return look.ending(task.goal, task.tolerance, doubt)

    def _may_look(self, time: float, since: float) -> bool:
        """Whether more pictures may still verify the goal, at ``time`` [s], of an object
        let go at ``since`` [s]. One that seems to have missed is looked at for less time.
        """
        task = self.plan.task
        if task.sensing.every_pose or task.tool is not None or self.state is None:
            return False
        pose = self.controller.filtered_pose(self.state)
        missed = self.controller.missed(self.state, pose) is not None
        longest = margins.ARM.longest_look if missed else margins.ARM.longest_last_look
        ends = min(since + longest, self.time_limit)
        return time + self.guard.period < ends

    def _retriable_ending(self, ending: Ending, pose: Pose2) -> Ending | None:
        """Failure from which the run can recover. None if it cannot, or if the arms
        have not drawn back.
        """
        if ending.code == "goal_reached":
            assert self.state is not None
            return self.controller.missed(self.state, pose)
        return ending if ending.code in RECOVERABLE else None

    def _may_correct(self, verified: Ending) -> bool:
        """Whether an object that seems to be at its goal, but is not surely there, is
        seen well enough to be moved again. That is done once: each motion may miss.
        """
        task = self.plan.task
        done = any(event["code"] == verified.code for event in self.events)
        if verified.code != "not_verified" or task.tool is not None or done:
            return False
        return self.last_look is not None and self.last_look.tells(task.tolerance)

    def _restart(self, pose: Pose2) -> Restart:
        """Start of the remaining task with the object at ``pose``, X_WG.

        Raises InfeasibleTaskError if the arms cannot let go of the object.
        """
        scene = self.plan.task.scene
        segment = self.controller.segments[0]
        found = NOTHING
        if self.state is not None:
            segment = self.state.following.segment
            found = estimates(self.state)
        elif any(self.approach.held):
            raise InfeasibleTaskError("one arm still holds the object")
        if not scene.carried(pose):
            raise InfeasibleTaskError("nothing but the arms carries the object")
        # presses that slid felt their own friction, not the support's
        if self._presses_slid and len(segment.contacts) > 1:
            found = found._replace(drag=None)
        start = restart(scene, segment, pose, found, self._known_center())
        friction = start.support_friction
        if found.drag is None:
            friction = self._dragged_friction() or friction
        body = self._pressed_body()
        if body is not None:
            start = replace(start, mass=body.mass, mass_error=body.mass_error)
            friction = body.friction
        start = replace(
            start,
            support_friction=friction,
            least_friction=self.least_friction,
            dares=self.before.dares,
        )
        if self.state is not None and self._slid:
            found_now = self.state.watches.tip_friction
            start = after_slides(start, scene, segment, found_now)
            self.tip_friction = found_now or self.tip_friction
        if self.tip_friction is None:
            return start
        told = self.tip_friction.value
        return replace(
            start, contact_friction=min(told, start.contact_friction or told)
        )

    def _hold(self, tick: Tick, measurement: Measurement) -> Commands:
        """Command all arms, or tips without arms, to hold their measured positions.
        Returns the commands.
        """
        held_commands: Commands = tuple(
            JointCommand(reading.q, np.zeros_like(reading.q))
            for reading, _ in tick.joints
        )
        if not tick.joints:
            held_commands = tuple(
                free_tip(tip.position, (0.0, 0.0, 0.0)) for tip in measurement.tips
            )
        self._send(held_commands)
        return held_commands

    def _check_in_time(self, plan: Plan) -> None:
        """Raise InfeasibleTaskError if ``plan``, started now, does not end in time."""
        needed = plan.duration + margins.ARM.regrasp * len(plan.placements)
        left = self.time_limit - self.cell.clock.time
        if needed > left:
            raise InfeasibleTaskError(
                f"another attempt takes {needed:.0f} s; limits.time leaves {left:.0f} s"
            )

    def _note(self, time: float, failure: Ending, missing: str | None = None) -> None:
        """Record the failure, and why there was no recovery."""
        self.events.append(
            {
                "time": time,
                "code": failure.code,
                "text": failure.text,
                "recovered": missing is None,
                "lacking": missing,
            }
        )

    def _resume(self, plan: Plan, held_commands: Commands) -> None:
        """Start ``plan`` now, in place of the rest of the present plan.

        The cell's clock has already advanced by the time spent on planning, during
        which the arms followed ``held_commands``.
        """
        measurement, _ = self.measure()
        time = measurement.time
        self._learn()
        self.earlier.append((self.plan, self.number + 1))
        self.plan = plan
        self.placements = plan.by_placement
        self.number = 0
        self.breach = None
        self.stopping = None
        self.looked_on = None
        self.last_look = None
        self.guard = self.guard.successor(plan.task.limits.normal_force, held_commands)
        self.cell.placements.hand_over(self.placements[0], frozenset())
        self._begin_placement((None,) * len(plan.task.robots), time, measurement)
        self.recorder.begin_placement(plan, 0)

    def _placement_done(self) -> bool:
        state = self.state
        return (
            state is not None
            and state.phase.name == "done"
            and state.phase.failure is None
        )

    def _ending(self, tick: Tick) -> Ending | None:
        """First ending reported by a watch."""
        for watch in self.watches:
            ending = watch(tick)
            if ending is not None:
                return ending
        return None

    def _finished(self, tick: Tick) -> Ending | None:
        stopping = self.stopping
        if stopping is not None and stopping.took_over:
            return self._stopped_short(stopping, tick.time)
        if self.state is None:
            return self.breach if self.approach.at_rest(tick.time) else None
        if self.state.phase.name != "done":
            return None
        failure = self.state.phase.failure
        return Ending("goal_reached") if failure is None else Ending(*failure)

    def _stopped_short(self, stopping: Stop, time: float) -> Ending | None:
        """Ending of a run whose arms stopped without drawing back, once they are at
        rest at ``time`` [s].
        """
        assert self.breach is not None
        if not stopping.at_rest(time):
            return None
        if self.breach.code != "runaway":
            braked = StopLevel.BRAKE in stopping.levels
            then = "ran away" if braked else "did not draw back"
            text = f"{self.breach.text}; then an arm {then}"
            self.breach = Ending(self.breach.code, text)
        return self.breach

    def _failed(self, tick: Tick) -> Ending | None:
        reason = self.cell.clock.failure()
        return None if reason is None else Ending("diverged", reason)

    def _stopped(self, tick: Tick) -> Ending | None:
        if not self.options.stop():
            return None
        text = f"stopped by the user at {tick.time:.1f} s"
        return Ending("interrupted", text)

    def _report(self, time: float) -> None:
        self.ticks += 1
        progress = self.options.progress
        if progress is not None and self.ticks % PROGRESS_TICKS == 0:
            progress(time, self.expected)


def _runaway(runaways: Sequence[str | None]) -> Ending | None:
    """Ending of a run in which joints run away, from the descriptions of all arms."""
    for arm, text in enumerate(runaways):
        if text is not None:
            return Ending("runaway", f"arm {arm} runs away: {text}")
    return None


def still(commands: Commands, tips: Sequence[TipState]) -> Commands:
    """Commands that hold ``tips`` in place with their present press."""
    return tuple(
        _still(command, tip) if isinstance(command, TipCommand) else command
        for command, tip in zip(commands, tips, strict=True)
    )


def _still(command: TipCommand, tip: TipState) -> TipCommand:
    x, y, _ = tip.position
    along, across, _ = FREE_STIFFNESS
    slow, slower, _ = FREE_DAMPING
    return replace(
        command,
        force=(0.0, 0.0, command.force[2]),
        position=(x, y, command.position[2]),
        velocity=(0.0, 0.0, 0.0),
        stiffness=(along, across, command.stiffness[2]),
        damping=(slow, slower, command.damping[2]),
        tool_yaw_rate=0.0,
        acceleration=(0.0, 0.0, 0.0),
        tool_yaw_acceleration=0.0,
    )


def tip_paths(
    placement: Plan, held_commands: TipCommands, measurement: Measurement | None
) -> list[TipPath | None]:
    """Path of each tip without an arm, over the object, to a point before its planned
    contact.

    A tip without a contact goes to its robot's base and waits there. None for a tip
    that keeps its contact, and at the start of a run.
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
        start = measurement.tips[arm].position
        waits = arm not in ends and math.dist(start, base) < AT_BASE
        if held_commands[arm] is None and not waits:
            above = scene.body.shape.height + robot.tip_radius + gap
            paths[arm] = tip_path(start, ends.get(arm, base), above)
    return paths
