"""Whole runs on the planar engine: recording, hand-over and recovery."""

from __future__ import annotations

import gc
import math
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Applied, Arm, ArmState, TipAlone
from pushpressslide.control.recording import PATH_SAMPLES
from pushpressslide.control.run_loop import TOUCH_AND_RELEASE, RunOptions, run_loop
from pushpressslide.core import margins
from pushpressslide.core.control import PHASES, ArmCommand, Commands, TipCommand
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Record
from pushpressslide.planar.cell import planar_cell

PERIOD = 0.01
SLOW = f"motion.control_period={PERIOD}"
JUMP = 5.0  # [s] at which a tip's reference jumps in the run that is recovered


class Diary:
    """The planar engine, which writes down what its tips are commanded, and when."""

    def __init__(self, plan: Plan) -> None:
        cell = planar_cell(plan)
        self.clock = cell.clock
        arms = [Noted(self, number, arm) for number, arm in enumerate(cell.arms)]
        self.cell = replace(cell, arms=arms)
        self.commands: list[tuple[float, Commands]] = []

    def note(self, number: int, command: ArmCommand) -> None:
        """Note a command; they come in the order of the arms."""
        if number == 0:
            self.commands.append((self.clock.time, ()))
        time, commands = self.commands[-1]
        assert (self.clock.time, number) == (time, len(commands))
        self.commands[-1] = (time, (*commands, command))


class Noted(TipAlone):
    """A tip whose commands are written down."""

    def __init__(self, diary: Diary, number: int, tip: Arm) -> None:
        self.diary = diary
        self.number = number
        self.tip = tip

    def read(self) -> ArmState:
        return self.tip.read()

    def send(self, command: ArmCommand) -> Applied:
        self.diary.note(self.number, command)
        return self.tip.send(command)


@dataclass(frozen=True)
class Run:
    """A run, and what its tips were commanded."""

    plan: Plan  # that it began with
    record: Record
    commands: list[tuple[float, Commands]]

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        return dict(self.record.arrays)

    @property
    def phases(self) -> list[str]:
        """The phases in their order, each once."""
        return [PHASES[int(p)] for p, _ in groupby(self.arrays["phase"])]

    @property
    def segments(self) -> list[Segment]:
        """All segments that were planned, in their order."""
        return [s for part in self.record.plan.by_placement for s in part.segments]


def run(name: str, *overrides: str, **options: Any) -> Run:
    plan = pps.plan(pps.load_task(name, [SLOW, *overrides]))
    diary = Diary(plan)
    record = run_loop(diary.cell, plan, RunOptions(**options))
    return Run(plan, record, diary.commands)


def jump(time: float, commands: Commands) -> Commands:
    """Return the commands, for a tick with all references 5 cm higher."""
    if not JUMP <= time < JUMP + PERIOD:
        return commands
    return tuple(raised(command) for command in commands)


def raised(command: Any) -> Any:
    if not isinstance(command, TipCommand):
        return command
    x, y, z = command.position
    return replace(command, position=(x, y, z + 0.05))


@pytest.fixture(scope="module")
def two() -> Run:
    """A run of two placements, one of whose arms keeps its contact."""
    return run("pivot-and-move")


@pytest.fixture(scope="module")
def told() -> list[tuple[float, float]]:
    """Times and expected durations that the recovered run tells."""
    return []


@pytest.fixture(scope="module")
def recovered(told: list[tuple[float, float]]) -> Run:
    """A run in which a reference jumps, with noise on the poses."""
    noise = "sensing.position_noise=0.0003"

    def progress(time: float, expected: float) -> None:
        told.append((time, expected))

    return run("rear-push-rear", noise, disturb=jump, seed=5, progress=progress)


@pytest.fixture(scope="module")
def pair() -> Run:
    """A run of two pushes side by side."""
    return run("parallel-push")


@pytest.fixture(scope="module")
def car() -> Run:
    """A run of two segments, one after the other with the same contact."""
    return run("press-slide-car")


@pytest.fixture(params=["two", "recovered", "pair", "car"])
def any_run(request: pytest.FixtureRequest) -> Run:
    found: Run = request.getfixturevalue(request.param)
    return found


def test_a_run_reaches_its_goal_in_the_order_of_its_phases(any_run: Run) -> None:
    assert any_run.record.reason == "goal_reached"
    assert any_run.record.engine == "planar"
    once = ["touch", "move", "release"]
    phases = [phase for phase in any_run.phases if phase not in ("approach", "done")]
    placements = int(any_run.arrays["placement"].max()) + 1
    assert phases == once * placements


def test_every_tick_has_a_row_of_each_array(any_run: Run) -> None:
    arrays = any_run.arrays
    count = len(any_run.arrays["time"])
    assert arrays["time"] == pytest.approx(PERIOD * np.arange(count))
    rows = {name: len(a) for name, a in arrays.items() if not name.startswith("plan_")}
    assert set(rows.values()) == {count}


def test_placements_and_segments_are_counted_over_the_whole_run(any_run: Run) -> None:
    arrays = any_run.arrays
    segments = any_run.segments
    assert sorted(set(arrays["stretch"])) == list(range(len(segments)))
    assert (np.diff(arrays["stretch"]) >= 0.0).all()
    placements = [part.segments for part in any_run.record.plan.by_placement]
    numbers = [i for i, group in enumerate(placements) for _ in group]
    for stretch, number, leg in zip(
        arrays["stretch"], arrays["placement"], arrays["leg"], strict=True
    ):
        assert numbers[int(stretch)] == number
        assert segments[int(stretch)].leg == leg


def test_the_vehicle_frame_is_that_of_the_segment_about_the_first_centre(
    any_run: Run,
) -> None:
    arrays = any_run.arrays
    X_BG = any_run.plan.task.X_GB.inverse()
    begun = any_run.record.plan.by_placement
    moving = arrays["phase"] == PHASES.index("move")
    for number in range(len(begun)):
        rows = np.flatnonzero(moving & (arrays["placement"] == number))
        X_GB = begun[number].task.X_GB
        segment = begun[number].segments[0]
        frame = X_BG.compose(X_GB).compose(segment.X_BV)
        first = arrays["vehicle_frame"][rows[0]]
        assert first[:2] == pytest.approx(frame.position, abs=2e-3)


def test_the_planned_paths_are_recorded_from_end_to_end(any_run: Run) -> None:
    arrays = any_run.arrays
    segments = any_run.segments
    stretch = arrays["plan_stretch"]
    assert stretch.tolist() == sorted(stretch)
    assert sorted(set(stretch)) == list(range(len(segments)))
    for i, segment in enumerate(segments):
        path = arrays["plan_path"][stretch == i]
        assert len(path) == PATH_SAMPLES
        steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
        assert steps.max() < 3.0 * segment.path.length / len(path)
        there = Pose2(*path[-1]).compose(segment.X_BV.inverse())
        goal = segment.goal
        assert math.dist(there.position, goal.position) < 0.03


def test_each_mode_is_named_once_for_each_time_it_is_taken(any_run: Run) -> None:
    used = [segment.mode for segment in any_run.segments]
    assert list(any_run.record.modes) == [mode for mode, _ in groupby(used)]


def test_a_tip_is_asked_for_its_force_and_what_its_servo_adds(any_run: Run) -> None:
    """Where it has a command; an arm without one has none."""
    arrays = any_run.arrays
    forces = arrays["command_force"]
    demanded = arrays["demanded_force"]
    tips = arrays["tip_position"]
    none = np.isnan(forces)
    assert (none == np.isnan(demanded)).all()
    assert (none == np.isnan(arrays["tip_reference"])).all()
    releasing = arrays["phase"] == PHASES.index("release")
    off = arrays["tip_reference"][releasing] - tips[releasing]
    added = demanded[releasing] - forces[releasing]
    # drawn back by its spring: along the way there is
    along = np.nansum(off * added, axis=-1)
    far = np.linalg.norm(off, axis=-1) > 2e-3
    assert (along[far] > 0.0).all()


def test_wrenches_that_are_wanted_are_those_that_are_allocated(any_run: Run) -> None:
    arrays = any_run.arrays
    moving = arrays["phase"] == PHASES.index("move")
    wanted = arrays["wanted_wrench"]
    given = arrays["allocated_wrench"]
    assert not wanted[~moving].any()
    assert not given[~moving].any()
    assert np.linalg.norm(wanted[moving], axis=1).min() > 0.0
    off = np.linalg.norm(given - wanted, axis=1)[moving]
    assert np.median(off) < 1e-9
    assert off.max() < np.linalg.norm(wanted, axis=1).max()


def test_times_of_a_tick_are_parts_of_its_total(any_run: Run) -> None:
    arrays = any_run.arrays
    moving = arrays["phase"] == PHASES.index("move")
    parts = arrays["tick_track"] + arrays["tick_allocate"]
    assert (parts <= arrays["tick_total"]).all()
    assert (arrays["tick_track"][moving] > 0.0).all()
    assert (arrays["tick_allocate"][moving] > 0.0).all()
    assert not parts[~moving].any()
    assert (arrays["tick_total"] > 0.0).all()


def test_the_reference_leads_from_the_start_to_the_goal(any_run: Run) -> None:
    task = any_run.plan.task
    reference = any_run.arrays["reference_pose"]
    start = reference[0]
    end = reference[-1]
    assert start[:2] == pytest.approx(task.start.position, abs=1e-6)
    assert end[:2] == pytest.approx(task.goal.position, abs=1e-3)
    assert wrap_angle(end[2] - task.goal.yaw) == pytest.approx(0.0, abs=1e-2)
    assert np.abs(reference[:, 2]).max() <= math.pi
    steps = np.hypot(*np.diff(reference[:, :2], axis=0).T)
    same = np.diff(any_run.arrays["placement"]) == 0.0
    assert steps[same].max() < 3.0 * task.motion.speed * PERIOD


def test_progress_rises_along_each_segment(any_run: Run) -> None:
    arrays = any_run.arrays
    moving = arrays["phase"] == PHASES.index("move")
    for stretch in set(arrays["stretch"]):
        rows = moving & (arrays["stretch"] == stretch)
        progress = arrays["progress"][rows]
        assert progress[0] < 0.02
    length = any_run.segments[-1].path.length
    assert progress[-1] == pytest.approx(length, rel=0.2)


def test_before_they_move_an_object_tips_wait_for_each_other(pair: Run) -> None:
    """Both press on it when the first one is led on."""
    arrays = pair.arrays
    first = int(np.argmax(arrays["phase"] == PHASES.index("move")))
    pressed = np.linalg.norm(arrays["measured_force"][first - 1], axis=-1)
    assert pressed.min() > 0.3


def test_tips_draw_back_and_rest_at_the_end(any_run: Run) -> None:
    """As far as a retreat is, along what they pushed."""
    arrays = any_run.arrays
    tips = arrays["tip_position"]
    released = np.flatnonzero(arrays["phase"] == PHASES.index("release"))
    groups = np.split(released, np.flatnonzero(np.diff(released) > 1) + 1)
    last = groups[-1]
    way = np.linalg.norm(tips[last[-1]] - tips[last[0]], axis=-1)
    retreat = margins.ARM.retreat
    assert way == pytest.approx(np.full(len(way), retreat), abs=0.1 * retreat)
    assert np.abs(tips[last[-1]] - tips[last[-3]]).max() < 1e-4
    # smoothly: nothing jerks back
    steps = np.linalg.norm(np.diff(tips[last], axis=0), axis=-1)
    assert steps.max() < 0.3 * PERIOD


def test_tips_travel_over_the_object_between_two_placements(two: Run) -> None:
    arrays = two.arrays
    travelling = arrays["phase"] == PHASES.index("approach")
    assert travelling.sum() > 100
    tips = arrays["tip_position"][travelling]
    assert tips[:, :, 2].max(axis=0).min() > two.plan.task.object.shape.height
    before = np.linalg.norm(np.diff(tips, axis=0), axis=-1) / PERIOD
    assert before.max() < 0.3  # [m/s]
    assert (np.nan_to_num(arrays["measured_force"][travelling]) == 0.0).all()


def test_a_jump_is_recovered_from_once_and_told(recovered: Run) -> None:
    (event,) = recovered.record.meta["events"]
    assert event["code"] == "reference_jump"
    assert (
        event["text"].endswith(f"(at {JUMP:.2f} s, touch)") or "move" in (event["text"])
    )
    assert event["recovered"]
    assert event["lacking"] is None
    assert event["time"] > JUMP
    assert recovered.arrays["placement"].max() == 1.0
    assert len(recovered.record.plan.later) == 1


def test_after_a_recovery_its_plan_is_expected_to_take_its_time(
    recovered: Run, told: list[tuple[float, float]]
) -> None:
    """With a grasp before it."""
    (event,) = recovered.record.meta["events"]
    at = event["time"]
    before = {expected for time, expected in told if time < at}
    after = {expected for time, expected in told if time > at + PERIOD}
    assert len(before) == len(after) == 1
    plan = recovered.record.plan.by_placement[1]
    arrays = recovered.arrays
    approaches = arrays["phase"] == PHASES.index("approach")
    approach = PERIOD * np.count_nonzero(approaches & (arrays["placement"] == 1.0))
    assert approach > 1.0
    wanted = at + approach + TOUCH_AND_RELEASE + plan.duration
    assert after.pop() == pytest.approx(wanted, abs=2 * PERIOD)


def test_placements_that_were_not_begun_are_no_part_of_what_was_run() -> None:
    """Of a plan that another one took the place of."""
    ended = iter(range(round(9.0 / PERIOD)))
    made = run("pivot-and-move", disturb=jump, stop=lambda: next(ended, None) is None)
    assert made.record.meta["events"][0]["recovered"]
    first, *anew = made.record.plan.by_placement
    assert first.segments == made.plan.placements[0]
    (later,) = made.record.plan.later
    assert [part.segments for part in anew] == list(later.placements)


def test_a_command_that_jumps_never_reaches_the_tips(recovered: Run) -> None:
    heights = [
        max(command.position[2] for command in commands if command is not None)
        for _, commands in recovered.commands
    ]
    before = [
        h for (t, _), h in zip(recovered.commands, heights, strict=True) if t < JUMP
    ]
    at = next(
        h for (t, _), h in zip(recovered.commands, heights, strict=True) if t >= JUMP
    )
    assert at < before[-1] + 0.01


def test_tips_hold_where_they_are_while_another_plan_is_made(recovered: Run) -> None:
    times = [time for time, _ in recovered.commands]
    twice = [i for i in range(1, len(times)) if times[i] == times[i - 1]]
    (number,) = twice
    time, (held,) = recovered.commands[number - 1]
    assert isinstance(held, TipCommand)
    seen = recovered.arrays["tip_position"][round(time / PERIOD) - 1, 0]
    assert held.position == pytest.approx(seen, abs=2e-3)
    assert held.velocity == (0.0, 0.0, 0.0)
    assert held.force == (0.0, 0.0, 0.0)


def test_the_same_run_ends_where_nothing_may_be_recovered_from() -> None:
    made = run("rear-push-rear", "motion.recoveries=0", disturb=jump)
    assert made.record.reason == "reference_jump"
    assert made.record.reason_text.endswith("(at 5.01 s, move)")
    assert made.record.meta["events"] == []
    assert made.record.plan.later == ()
    assert made.record.seed == 0
    # slowed down, drawn back and at rest
    tips = made.arrays["tip_position"][:, 0]
    released = tips[made.arrays["phase"] == PHASES.index("release")]
    way = math.dist(released[-1], released[0])
    assert way == pytest.approx(margins.ARM.retreat, abs=0.01)
    assert np.abs(tips[-1] - tips[-5]).max() < 1e-4


def test_nothing_is_begun_anew_for_which_no_time_is_left() -> None:
    made = run("rear-push-rear", "limits.time=24", disturb=jump)
    (event,) = made.record.meta["events"]
    assert not event["recovered"]
    assert "limits.time leaves" in event["lacking"]
    assert made.record.reason == "reference_jump"
    assert len(set(made.arrays["placement"])) == 1


def test_a_search_for_cycles_is_left_out_while_a_run_goes_on() -> None:
    """And is as it was afterwards."""
    seen: list[bool] = []

    def stop() -> bool:
        seen.append(gc.isenabled())
        return True

    for collects in (True, False):
        (gc.enable if collects else gc.disable)()
        try:
            assert run("press-slide", stop=stop).record.reason == "interrupted"
            assert gc.isenabled() == collects
        finally:
            gc.enable()
    assert seen == [False, False]


@pytest.mark.parametrize("segments", [1, 2])
def test_a_run_that_is_cut_off_tells_the_whole_plan_once(segments: int) -> None:
    """Also the paths that were not begun."""
    name = "press-slide-car"
    first = pps.plan(pps.load_task(name, [SLOW])).segments[0].profile.duration
    end = 4.0 if segments == 1 else first + 8.0
    ticks = iter(range(round(end / PERIOD)))
    made = run(name, stop=lambda: next(ticks, None) is None)
    assert made.record.reason == "interrupted"
    assert sorted(set(made.arrays["stretch"])) == list(range(segments))
    assert sorted(set(made.arrays["plan_stretch"])) == [0.0, 1.0]
    assert len(made.record.plan.segments) == 2
