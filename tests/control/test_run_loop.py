"""The run loop, with a scripted controller and a plant that only records its calls."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from whole_plant import PlantRow, cell_of

import pushpressslide as pps
from pushpressslide.control import run_loop as module
from pushpressslide.control.approach import TRAVEL_SPEED
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.controller import Step
from pushpressslide.control.estimator import Estimator, ObjectEstimator
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.hand_eye import HandEye
from pushpressslide.control.identified import Identified
from pushpressslide.control.last_look import LastLook
from pushpressslide.control.limits import (
    MEAN_TIME,
    POSITION_MARGIN,
    ArmLimits,
    ArmReading,
)
from pushpressslide.control.run_loop import (
    PROGRESS_TICKS,
    RunLoop,
    RunOptions,
    still,
    tip_paths,
)
from pushpressslide.control.state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    PhaseState,
    tip_position,
)
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core import margins
from pushpressslide.core.control import (
    PHASES,
    Commands,
    ControlLog,
    JointCommand,
    Measurement,
    Thought,
    TipCommand,
    TipState,
)
from pushpressslide.core.plan import JointPath, Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.scene import Scene
from pushpressslide.core.task import Motion, Sensing, Task
from pushpressslide.identification.parameter import Parameter
from pushpressslide.identification.tip_friction import TipFriction

PERIOD = 0.01
TICKS = 10  # that a scripted placement takes
STOP_TICKS = 3  # that a scripted controller takes to stop safely
ZERO = (0.0, 0.0, 0.0)
PUSH = TipCommand((3.0, 0.0, 0.0), (1.0, 2.0, 3.0), ZERO, ZERO, ZERO, 0, 0, 0, 5.0, 0.0)
APPROACH = JointPath(
    approach_time=np.array([0.0, 0.03]),
    approach=np.array([[0.0, 0.0], [0.3, -0.3]]),
    arc_length=np.array([0.0, 1.0]),
    move=np.array([[0.3, -0.3], [1.0, 1.0]]),
    tool_yaw_offset=0.0,
    joint_margin=1.0,
    condition=1.0,
    clearance=1.0,
    gap=0.001,
)


LIMITS = ArmLimits(
    lower=np.full(2, -2.0),
    upper=np.full(2, 2.0),
    velocity=np.full(2, 20.0),
    effort=np.full(2, 50.0),
    torque_rate=np.full(2, 1e3),
)


@dataclass
class Diary:
    """A plant on which nothing moves; it writes down what is asked of it."""

    arms: int
    force: float = 0.0  # [N] that every tip measures
    breaks_after: float = np.inf  # [s]
    joint_paths: tuple[JointPath, ...] = ()
    name: str = "diary"
    meta: dict[str, Any] = field(default_factory=lambda: {"kind": "diary"})
    reading: ArmReading | None = None  # of every arm
    ticks: int = 0
    asked: list[str] = field(default_factory=list)
    applied: list[Commands] = field(default_factory=list)
    handed_over: list[tuple[Plan, frozenset[int]]] = field(default_factory=list)

    @property
    def time(self) -> float:
        return self.ticks * PERIOD

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        return (LIMITS,) * self.arms if self.joint_paths else ()

    def readings(self) -> tuple[ArmReading, ...]:
        reading = self.reading or ArmReading(np.zeros(2), np.zeros(2))
        return (reading,) * self.arms if self.joint_paths else ()

    def measure(self) -> Measurement:
        self.asked.append("measure")
        tip = TipState(ZERO, ZERO, (0.0, 0.0, -self.force))
        return Measurement(self.time, Pose2(0.1, 0.2, 0.3), (tip,) * self.arms)

    def apply(self, commands: Commands) -> None:
        self.asked.append("apply")
        self.applied.append(commands)

    def advance(self) -> None:
        self.asked.append("advance")
        self.ticks += 1

    def row(self) -> PlantRow:
        self.asked.append("row")
        ticks = self.ticks
        forces = (ZERO,) * self.arms
        return PlantRow(ZERO, forces, extras=lambda: {"extra": ticks})

    def diverged(self) -> str | None:
        return "it broke" if self.time > self.breaks_after else None

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        self.handed_over.append((placement, kept_arms))


@dataclass(frozen=True)
class Followed:
    """What the scripted controller follows."""

    reference: Segment
    began: float | None = None


@dataclass(frozen=True)
class Line:
    """The scripted controller's state."""

    phase: PhaseState
    following: Followed
    step: int = 0


class Script:
    """A controller that pushes for TICKS ticks and is done; arm 0 keeps its contact."""

    made: list[Script]
    failure: tuple[str, str] | None = None
    phase = "move"

    def __init__(
        self,
        plan: Plan,
        number: int = 0,
        gap: float | None = None,
        back: float = math.inf,
        execution: Execution = USUAL,
        estimator: Callable[[Task], Estimator] = ObjectEstimator,
    ) -> None:
        self.back = back
        self.halts: list[float] = []
        self.segments = plan.placements[number]
        self.arms = len(plan.task.robots)
        self.gap = gap
        self.kept_arms = frozenset({0})
        self.seen: list[Measurement] = []
        self.held: Commands = ()
        self.made.append(self)

    def init(self, measurement: Measurement, held: Commands) -> Line:
        self.held = held
        phase = PhaseState(self.phase, measurement.time, ())
        return Line(phase, Followed(self.segments[0]))

    def untouched(self, state: Line) -> tuple[int, ...]:
        return ()

    def filtered_pose(self, state: Line) -> Pose2:
        return Pose2()

    def last_look(self, state: Line) -> LastLook:
        return LastLook(Pose2(), (0.0, 0.0))

    def identified(self, state: Line, belief: Scene) -> Identified:
        return Identified()

    def withstood_friction(self, state: Line) -> float:
        return 0.0

    def missed(self, state: Line, pose: Pose2) -> None:
        """Nothing is missed."""

    def normal_forces(self, state: Line, measurement: Measurement) -> list[float]:
        return [-tip.force[2] for tip in measurement.tips]

    def stop(
        self, state: Line, measurement: Measurement, failure: tuple[str, str]
    ) -> Line:
        phase = state.phase._replace(failure=failure)
        return replace(state, step=TICKS - STOP_TICKS, phase=phase)

    def halted(self, state: Line, measurement: Measurement) -> Line:
        self.halts.append(measurement.time)
        return state

    def step(self, state: Line, measurement: Measurement) -> Step:
        self.seen.append(measurement)
        log = ControlLog("move", 0.0, lambda: Thought(Pose2()))
        last = state.step + 1 == TICKS
        phase = state.phase._replace(
            name="done" if last else self.phase,
            failure=state.phase.failure or (self.failure if last else None),
        )
        next_state = replace(state, step=state.step + 1, phase=phase)
        return Step((PUSH,) * self.arms, log, next_state, None)


def run_loop(plant: Diary, plan: Plan, options: RunOptions | None = None) -> Record:
    """Run with the scripted controller."""
    scripted = replace(options or RunOptions(), controller=Script)
    return module.run_loop(cell_of(plant, plant.arms), plan, scripted)


@pytest.fixture(scope="module")
def one() -> Plan:
    """A plan with one arm and one placement."""
    return shortened(pps.plan(pps.load_task("rear-push-rear")), 1.0)


@pytest.fixture(scope="module")
def two() -> Plan:
    """A plan with two arms and two placements."""
    plan = shortened(pps.plan(pps.load_task("pivot-and-move")), 60.0)
    assert len(plan.placements) == len(plan.task.robots) == 2
    return plan


@pytest.fixture
def scripts(monkeypatch: pytest.MonkeyPatch) -> list[Script]:
    """The controllers that a run makes, in order."""
    made: list[Script] = []
    monkeypatch.setattr(Script, "made", made, raising=False)
    monkeypatch.setattr(Script, "failure", None)
    return made


def shortened(plan: Plan, limit: float, sensing: Sensing | None = None) -> Plan:
    task = plan.task
    motion = replace(task.motion, control_period=PERIOD, recoveries=0)
    legs = tuple(
        replace(leg, motion=replace(leg.motion, control_period=PERIOD, recoveries=0))
        for leg in task.legs
    )
    limits = replace(task.limits, time=limit)
    sensing = sensing or task.sensing
    changed = replace(task, motion=motion, legs=legs, limits=limits, sensing=sensing)
    return replace(plan, task=changed)


def test_a_tick_measures_applies_advances_and_is_recorded(one, scripts) -> None:
    plant = Diary(arms=1)
    run_loop(plant, one)
    assert plant.asked == ["measure", "apply", "advance", "row"] * TICKS


@pytest.mark.parametrize("phase", ["move", "release"])
def test_tips_that_draw_back_stay_once_a_joint_is_near_its_limit(
    one, scripts, monkeypatch, phase: str
) -> None:
    monkeypatch.setattr(Script, "phase", phase)
    approaching = Diary(arms=1, joint_paths=(APPROACH,))
    room = np.linspace(0.1, POSITION_MARGIN + 0.001, TICKS)

    def readings() -> tuple[ArmReading, ...]:
        seen = len(scripts[0].seen) if scripts else 0
        q = np.array([0.0, 2.0 - room[min(seen, TICKS - 1)]])
        return (ArmReading(q, np.zeros(2)),)

    monkeypatch.setattr(approaching, "readings", readings)
    record = run_loop(approaching, one)
    assert record.reason == "goal_reached"
    (script,) = scripts
    first = int(np.argmax(room < margins.ARM.joint_buffer))
    late = [measurement.time for measurement in script.seen[first:]]
    assert script.halts == (late if phase == "release" else [])
    assert late


def test_the_controller_is_told_how_far_the_arms_can_draw_back(one, scripts) -> None:
    run_loop(Diary(arms=1, joint_paths=(replace(APPROACH, max_retreat=0.02),)), one)
    run_loop(Diary(arms=1), one)
    assert [script.back for script in scripts] == [0.02, math.inf]


def test_the_arm_with_the_least_room_and_gap_decides_for_both(two, scripts) -> None:
    near = replace(APPROACH, max_retreat=0.02, gap=0.003)
    far = replace(APPROACH, max_retreat=0.05, gap=0.004)
    for paths in ((near, far), (far, near)):
        run_loop(Diary(arms=2, joint_paths=paths), two)
    assert {script.back for script in scripts} == {0.02}
    assert {script.gap for script in scripts} == {0.003}


@pytest.mark.parametrize("code", [None, "contact_lost", "goal_missed"])
def test_what_is_known_of_tips_that_find_no_object_is_forgotten(
    one, scripts, monkeypatch, code: str | None
) -> None:
    monkeypatch.setattr(Script, "failure", None if code is None else (code, ""))
    cell = cell_of(Diary(arms=1), 1)
    loop = module.RunLoop(cell, one, RunOptions(controller=Script))
    known = {0: HandEye((0.01, 0.0))}
    loop.hand_eyes.update(known)
    with cell.connected():
        loop.run()
    assert loop.hand_eyes == ({} if code == "contact_lost" else known)


@pytest.mark.parametrize("slid", [False, True])
def test_presses_that_slid_tell_no_centre_of_mass(
    one, scripts, monkeypatch, slid: bool
) -> None:
    found = {
        "center_of_mass": Parameter(0.01, 0.002, 0.0, (1.0, 0.0)),
        "rho": Parameter(0.05, 0.002, 0.0),
    }
    monkeypatch.setattr(Script, "identified", lambda *_: Identified(found))
    monkeypatch.setattr(module.RunLoop, "_presses_slid", slid)
    cell = cell_of(Diary(arms=1), 1)
    loop = module.RunLoop(cell, one, RunOptions(controller=Script))
    believed = replace(loop.believed, center_error=0.02)
    loop.center = before = CenterBelief.before_run(believed)
    with cell.connected():
        record = loop.run()
    kept = {"rho"} if slid else set(found)
    assert set(record.meta["parameters"]) == kept
    assert (loop.center == before) == slid


def test_every_tick_is_recorded_once_and_at_its_own_time(one, scripts) -> None:
    record = run_loop(Diary(arms=1), one)
    assert record.arrays["time"].tolist() == [i * PERIOD for i in range(TICKS)]
    assert {
        len(rows) for name, rows in record.arrays.items() if "plan_" not in name
    } == {TICKS}


def test_the_record_holds_what_the_plant_adds(one, scripts) -> None:
    record = run_loop(Diary(arms=1), one)
    meta = {"kind": "diary", "controller": "Script", "events": [], "breaches": []}
    assert (record.engine, record.meta) == ("diary", meta)
    assert record.arrays["extra"].tolist() == [i + 1 for i in range(TICKS)]
    assert (record.arrays["tick_execute"] > 0.0).all()
    assert (record.arrays["tick_execute"] < record.arrays["tick_total"]).all()


LIMIT = 40.0  # [N] limits.normal_force of the task
OVERLOAD = 1.2 * LIMIT


@pytest.mark.parametrize(
    ("plant", "options", "limit", "failure", "code"),
    [
        ({}, {}, 1.0, None, "goal_reached"),
        ({}, {}, 1.0, ("contact_lost", "it is gone"), "contact_lost"),
        ({}, {}, 0.5 * TICKS * PERIOD, None, "time_limit"),
        ({}, {"stop": lambda: True}, 1.0, None, "interrupted"),
        ({"breaks_after": 2.5 * PERIOD}, {}, 1.0, None, "diverged"),
        ({"force": OVERLOAD}, {}, 1.0, None, "force_limit"),
    ],
)
def test_a_run_ends_for_every_reason_and_says_so(
    one: Plan,
    scripts: list[Script],
    monkeypatch: pytest.MonkeyPatch,
    plant: dict[str, float],
    options: dict[str, Any],
    limit: float,
    failure: tuple[str, str] | None,
    code: str,
) -> None:
    monkeypatch.setattr(Script, "failure", failure)
    plan = shortened(one, limit)
    record = run_loop(Diary(arms=1, **plant), plan, RunOptions(**options))
    assert record.reason == code
    assert bool(record.reason_text) == (code != "goal_reached")
    ends = {
        "goal_reached": TICKS,
        "contact_lost": TICKS,
        "time_limit": TICKS // 2,
        "interrupted": 1,
        "diverged": 3,
        "force_limit": round(MEAN_TIME / PERIOD) - 1 + STOP_TICKS,
    }
    assert len(record.arrays["time"]) == ends[code]


def test_a_goal_that_is_reached_counts_before_any_watch(one, scripts) -> None:
    plant = Diary(arms=1, breaks_after=(TICKS - 0.5) * PERIOD)
    record = run_loop(plant, one, RunOptions(stop=lambda: plant.ticks == TICKS))
    assert record.reason == "goal_reached"


def test_placements_are_handed_over_in_order(two, scripts) -> None:
    plant = Diary(arms=2)
    record = run_loop(plant, two)
    assert [script.segments for script in scripts] == list(two.placements)
    assert plant.handed_over == [(two.by_placement[1], frozenset({0}))]
    assert record.reason == "goal_reached"
    legs = record.arrays["leg"]
    travelling = record.arrays["phase"] == PHASES.index("approach")
    assert (legs[:TICKS] == 0.0).all()
    assert (legs[TICKS:] == 1.0).all()
    assert not travelling[:TICKS].any()
    assert travelling[TICKS:-TICKS].all()
    assert not travelling[-TICKS:].any()


def test_a_tip_without_an_arm_travels_to_its_next_contact(two, scripts) -> None:
    plant = Diary(arms=2)
    run_loop(plant, two)
    travel = [commands for commands in plant.applied if commands[1] is not PUSH]
    held, moving = zip(*travel, strict=True)
    assert set(held) == {PUSH}
    places = np.array([command.position for command in moving])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.max() < 1.01 * TRAVEL_SPEED * PERIOD
    contact = next(c for c in two.placements[1][0].contacts if c.arm == 1)
    query = two.by_placement[1].query
    X_WB = query.start.compose(query.X_GB)
    gap = query.motion.approach_distance
    radius = query.scene.robots[1].tip_radius
    assert places[-1] == pytest.approx(tip_position(contact, X_WB, radius, gap))


def test_every_tick_is_measured_once_over_a_hand_over_too(two, scripts) -> None:
    plant = Diary(arms=2)
    run_loop(plant, two)
    assert plant.asked == ["measure", "apply", "advance", "row"] * plant.ticks


def test_only_arms_that_keep_their_contact_are_held(two, scripts) -> None:
    run_loop(Diary(arms=2), two)
    assert [script.held for script in scripts] == [(None, None), (PUSH, None)]


def test_after_a_failure_nothing_is_handed_over(two, scripts, monkeypatch) -> None:
    monkeypatch.setattr(Script, "failure", ("contact_lost", "it is gone"))
    plant = Diary(arms=2)
    assert run_loop(plant, two).reason == "contact_lost"
    assert not plant.handed_over


def approached(two: Plan, **options: Any) -> tuple[Diary, Record]:
    plant = Diary(arms=2, joint_paths=(APPROACH, APPROACH))
    return plant, run_loop(plant, two, RunOptions(**options))


def test_joints_lead_to_the_contact_before_the_controller_acts(two, scripts) -> None:
    plant, record = approached(two)
    waiting = record.arrays["phase"] == PHASES.index("approach")
    begins = [i for i, (a, b) in enumerate(pairwise(waiting)) if a and not b]
    assert waiting[0]
    assert len(begins) == 2
    first, _ = scripts
    assert first.seen[0].time == pytest.approx((begins[0] + 1) * PERIOD)
    assert len(first.seen) == TICKS
    for commands in plant.applied[: begins[0] + 1]:
        assert all(isinstance(command, JointCommand) for command in commands)
    assert np.isnan(record.arrays["command_force"][: begins[0] + 1]).all()


def test_an_arm_that_is_held_obeys_its_tip_command_while_others_approach(
    two, scripts
) -> None:
    plant, record = approached(two)
    waiting = record.arrays["phase"] == PHASES.index("approach")
    second = np.flatnonzero(waiting & (record.arrays["leg"] == 1.0))
    assert len(second)
    for i in second:
        held, free = plant.applied[i]
        assert isinstance(held, TipCommand)
        assert held == PUSH
        assert held.posture is not None
        assert isinstance(free, JointCommand)
    assert (record.arrays["command_force"][second, 0] == PUSH.force).all()


def test_the_controller_knows_the_gap_that_the_approach_leaves(two, scripts) -> None:
    approached(two)
    assert [script.gap for script in scripts] == [APPROACH.gap, APPROACH.gap]


def test_a_disturbance_reaches_the_arms_but_not_the_record(two, scripts) -> None:
    plant, record = approached(two, disturb=lambda time, commands: (None, None))
    moving = record.arrays["phase"] == PHASES.index("move")
    sent = [commands == (None, None) for commands in plant.applied]
    assert sent == moving.tolist()
    assert (record.arrays["command_force"][moving] == PUSH.force).all()


def test_a_seed_decides_what_the_controller_sees(one, scripts) -> None:
    noisy = shortened(one, 1.0, Sensing(position_noise=1e-3))
    records = [run_loop(Diary(1), noisy, RunOptions(seed=s)) for s in (3, 3, 4)]
    first, again, other = (script.seen for script in scripts)
    assert first == again
    assert first != other
    for record in records:  # the truth has no noise
        assert set(record.arrays["object_pose"][:, 0]) == {0.1}


def test_progress_is_told_with_the_expected_duration(one) -> None:
    told: list[tuple[float, float]] = []
    plant = Diary(arms=1)
    options = RunOptions(progress=lambda *times: told.append(times))
    module.run_loop(cell_of(plant, plant.arms), one, options)
    expected = module.TOUCH_AND_RELEASE + one.duration
    assert [time for time, _ in told] == pytest.approx(
        [(i * PROGRESS_TICKS - 1) * PERIOD for i in range(1, len(told) + 1)]
    )
    assert len(told) == plant.ticks // PROGRESS_TICKS
    assert [total for _, total in told] == pytest.approx([expected] * len(told))


def breached(two: Plan, **plant: Any) -> tuple[Diary, Record]:
    diary = Diary(arms=2, joint_paths=(APPROACH, APPROACH), **plant)
    return diary, run_loop(diary, two)


def test_a_breach_in_the_approach_brings_the_arms_to_rest(two, scripts) -> None:
    fast = ArmReading(np.zeros(2), np.array([0.0, 20.1]))
    plant, record = breached(two, reading=fast)
    assert record.reason == "joint_limit"
    text = "arm 0: joint 2 at 20.10 rad/s, allowed 20 rad/s"
    assert record.reason_text.startswith(f"{text} (at 0.00 s, approach)")
    assert not scripts[0].seen
    last = plant.applied[-1]
    assert [np.abs(command.velocity).max() for command in last] == [0.0, 0.0]


def test_a_refused_reference_never_reaches_the_arms(two, scripts) -> None:
    jump = replace(PUSH, position=(1.5, 2.0, 3.0), stiffness=(1.0, 1.0, 1.0))
    held = replace(PUSH, stiffness=(1.0, 1.0, 1.0))
    plant = Diary(arms=2)

    def disturb(time: float, commands: Commands) -> Commands:
        return (jump if time > 3.5 * PERIOD else held, None)

    record = run_loop(plant, two, RunOptions(disturb=disturb))
    assert record.reason == "reference_jump"
    assert "jumps by 500 mm, allowed 20 mm" in record.reason_text
    assert jump not in [commands[0] for commands in plant.applied]


def test_a_delay_is_one_in_time_over_a_hand_over(two, scripts) -> None:
    """The first measurement of a placement is no older than the delay."""
    delayed = shortened(two, 60.0, Sensing(delay=0.03))

    class Clock(Diary):
        def measure(self) -> Measurement:
            truth = super().measure()
            return replace(truth, object_pose=Pose2(self.time, 0.0, 0.0))

    run_loop(Clock(arms=2), delayed)
    first = scripts[1].seen[0]
    assert first.time - first.object_pose.x == pytest.approx(0.03)


def tips_at(*places: tuple[float, float, float]) -> Measurement:
    tips = tuple(TipState(place, ZERO, ZERO) for place in places)
    return Measurement(0.0, Pose2(), tips)


def test_tips_travel_to_before_their_contacts_over_the_object(two: Plan) -> None:
    placement = two.by_placement[1]
    query = placement.query
    begin = (3.0, 2.0, 0.1)
    paths = tip_paths(placement, (None, None), tips_at(begin, begin))
    X_WB = query.start.compose(query.X_GB)
    gap = query.motion.approach_distance
    for contact in placement.contacts:
        path = paths[contact.arm]
        assert path is not None
        radius = query.scene.robots[contact.arm].tip_radius
        assert path.corners[0] == begin
        assert path.corners[-1] == tip_position(contact, X_WB, radius, gap)
        highest = max(corner[2] for corner in path.corners)
        assert highest == pytest.approx(query.body.shape.height + radius + gap)


def test_a_tip_that_holds_its_contact_stays_and_at_first_all_do(two: Plan) -> None:
    placement = two.by_placement[1]
    begin = (3.0, 2.0, 0.1)
    held, free = tip_paths(placement, (PUSH, None), tips_at(begin, begin))
    assert held is None
    assert free is not None
    assert tip_paths(placement, (None, None), None) == [None, None]


@pytest.mark.parametrize(("off", "waits"), [(0.009, True), (0.011, False)])
def test_a_tip_without_a_contact_travels_to_its_base_and_waits_there(
    two: Plan, off: float, waits: bool
) -> None:
    placement = two.by_placement[1]
    segments = tuple(
        replace(s, contacts=tuple(c for c in s.contacts if c.arm == 0))
        for s in placement.segments
    )
    alone = replace(placement, segments=segments)
    x, y, z = placement.query.scene.bases[1]
    led, path = tip_paths(
        alone, (None, None), tips_at((3.0, 2.0, 0.1), (x + off, y, z))
    )
    assert led is not None
    assert (path is None) == waits
    if path is not None:
        assert path.corners[-1] == (x, y, z)
    # a tip with a contact travels, wherever it is
    base = placement.query.scene.bases[0]
    assert tip_paths(alone, (None, None), tips_at(base, base))[0] is not None


def test_nothing_is_planned_anew_while_an_arm_still_holds_the_object(
    two: Plan, scripts: list[Script]
) -> None:
    task = two.task
    legs = tuple(replace(leg, motion=recovering(leg.motion)) for leg in task.legs)
    plan = replace(two, task=replace(task, motion=recovering(task.motion), legs=legs))

    class OnceFast(Diary):
        """Arms of which the second is too fast once, on its way to the second place."""

        fast: float | None = None  # [s] when it is

        def readings(self) -> tuple[ArmReading, ...]:
            first, second = super().readings()
            if self.handed_over and self.fast is None:
                self.fast = self.time
            if self.time == self.fast:
                second = replace(second, v=np.array([0.0, 20.1]))
            return first, second

    plant = OnceFast(arms=2, joint_paths=(APPROACH, APPROACH))
    record = run_loop(plant, plan)
    assert record.reason == "joint_limit"
    (event,) = record.meta["events"]
    assert not event["recovered"]
    assert event["lacking"] == "one arm still holds the object"


def recovering(motion: Motion) -> Motion:
    return replace(motion, recoveries=1)


def test_a_run_of_a_single_tick_is_recorded_too(one: Plan, scripts) -> None:
    class Rows(Diary):
        def row(self) -> PlantRow:
            return replace(super().row(), extras=lambda: {"extra": np.arange(3.0)})

    record = run_loop(Rows(arms=1), one, RunOptions(stop=lambda: True))
    assert record.arrays["extra"].tolist() == [[0.0, 1.0, 2.0]]
    assert record.arrays["time"].tolist() == [0.0]


def test_a_run_that_has_not_begun_has_a_record_without_ticks(one: Plan) -> None:
    record = RunLoop(cell_of(Diary(arms=1), 1), one).record(Ending("interrupted"))
    assert len(record.arrays["time"]) == 0
    assert record.reason == "interrupted"


def test_external_commands_reach_the_arms_for_one_period(one: Plan, scripts) -> None:
    plant = Diary(arms=1)
    loop = RunLoop(cell_of(plant, 1), one)
    measurement = loop.drive((PUSH,))
    assert plant.applied == [(PUSH,)]
    assert measurement.time == PERIOD


def test_a_tip_that_is_held_keeps_its_press_and_only_that() -> None:
    pressing = replace(
        PUSH,
        force=(3.0, 2.0, -7.0),
        velocity=(0.1, 0.2, 0.3),
        stiffness=(11.0, 12.0, 13.0),
        damping=(21.0, 22.0, 23.0),
    )
    tip = TipState((4.0, 5.0, 6.0), (0.1, 0.2, 0.3), ZERO)
    held, free = still((pressing, None), (tip, tip))
    assert free is None
    assert isinstance(held, TipCommand)
    assert held.force == (0.0, 0.0, -7.0)
    assert held.velocity == ZERO
    assert held.position == (4.0, 5.0, PUSH.position[2])
    assert (held.stiffness[2], held.damping[2]) == (13.0, 23.0)
    assert held.stiffness[:2] == FREE_STIFFNESS[:2]
    assert held.damping[:2] == FREE_DAMPING[:2]


def test_an_arm_that_fails_while_one_plans_leaves_no_thread_behind(
    one: Plan, scripts, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop = RunLoop(cell_of(Diary(arms=1), 1), one, RunOptions(controller=Script))
    clock = loop.cell.clock
    failed = threading.Event()

    def advance() -> None:
        failed.set()
        raise ConnectionError("the arm is gone")

    loop.step()
    monkeypatch.setattr(type(clock), "simulated", False)
    monkeypatch.setattr(clock, "advance", advance)
    before = set(threading.enumerate())
    with pytest.raises(ConnectionError) as failure:
        loop._while_holding(lambda: failed.wait(10.0), (PUSH,))
    for thread in set(threading.enumerate()) - before:
        thread.join(2.0)
        assert not thread.is_alive()
    assert "gone" in str(failure.value)  # its frames live until here


def test_a_pose_that_is_no_number_is_no_pose(one, scripts, monkeypatch) -> None:
    diary = Diary(arms=1)
    loop = RunLoop(cell_of(diary, 1), one, RunOptions(controller=Script))
    before, _ = loop.measure()
    assert before.pose_seen
    for wrong in (Pose2(math.nan, 0.2, 0.3), Pose2(0.1, 0.2, math.inf)):
        seen = StampedPose(diary.time, wrong)
        monkeypatch.setattr(loop, "tracker", SimpleNamespace(read=lambda X=seen: X))
        after, _ = loop.measure()
        assert after.object_pose == before.object_pose
        assert not after.pose_seen


def test_what_forces_have_told_is_known_to_every_later_plan(one: Plan, scripts) -> None:
    loop = RunLoop(cell_of(Diary(arms=1), 1), one, RunOptions(controller=Script))
    before = loop._restart(Pose2())
    assert (before.contact_friction, before.least_friction) == (None, 0.0)
    loop.tip_friction = TipFriction(0.7, 0.03, 20.0, 10.0)
    loop.least_friction = 0.25
    body = one.task.scene.body
    heavy = Parameter(0.6 * body.mass, 0.01 * body.mass, 0.4 * body.mass)
    loop.identified = Identified({"mass_times_friction": heavy})
    after = loop._restart(Pose2())
    assert after.contact_friction == 0.7
    assert after.least_friction == 0.25
    assert after.support_friction == pytest.approx(0.6)
    as_believed = heavy._replace(belief=heavy.value)
    loop.identified = Identified({"mass_times_friction": as_believed})
    assert loop._restart(Pose2()).support_friction == before.support_friction
