"""Looks at an object that the arms have let go of."""

from __future__ import annotations

from typing import Any, ClassVar

import pytest

from pushpressslide.control.controller import LETTING_GO, Controller
from pushpressslide.control.last_look import LastLook
from pushpressslide.control.run_loop import RunLoop, RunOptions, run_loop
from pushpressslide.control.state import ControllerState
from pushpressslide.core import margins
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.jobs.ask import plan
from pushpressslide.planar.cell import planar_cell
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import load_task

PERIODIC = ["sensing.pose_rate=50.0"]
TOLERANCE = 0.005  # [m]


class Unsure(Controller):
    """A controller that knows the pose well only after some looks."""

    looks: ClassVar[list[float]] = []
    needed: ClassVar[int] = 0

    def last_look(self, state: ControllerState) -> LastLook:
        look = super().last_look(state)
        self.looks.append(state.estimate.time)
        unsure = len(self.looks) < self.needed
        return look._replace(spread=(1.0, 0.0) if unsure else (0.0, 0.0))


class Off(Unsure):
    """The same, with an object that seems to have missed its goal."""

    def missed(self, state: ControllerState, pose: Pose2) -> Ending:
        return Ending("goal_missed", "off")


class Beside(Controller):
    """A controller that sees the object near the edge of the tolerance in the first
    placements, and at its goal in later ones.
    """

    made: ClassVar[int] = 0
    unsure: ClassVar[int] = 1

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        type(self).made += 1

    def last_look(self, state: ControllerState) -> LastLook:
        goal = self.placement.last.goal
        off = 0.9 * TOLERANCE if self.made <= self.unsure else 0.0
        return LastLook(Pose2(goal.x + off, goal.y, goal.yaw), (0.1 * TOLERANCE, 0.0))


@pytest.fixture(scope="module")
def push() -> Plan:
    return plan(load_task("rear-push-left", PERIODIC))


def run(
    push: Plan,
    needed: int,
    monkeypatch: pytest.MonkeyPatch,
    controller: type[Unsure] = Unsure,
) -> Record:
    monkeypatch.setattr(Unsure, "looks", [])
    monkeypatch.setattr(Unsure, "needed", needed)
    return run_loop(planar_cell(push), push, RunOptions(controller=controller))


def test_it_is_looked_at_until_it_is_known_well(
    push: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = run(push, 40, monkeypatch)
    assert record.reason == "goal_reached"
    assert len(Unsure.looks) == 40
    assert result(push.task, push, record)["verified"]
    assert record.meta["last_look"]["spread"] == [0.0, 0.0]


def test_what_stays_unsure_is_not_verified(
    push: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = run(push, 10_000, monkeypatch)
    assert record.reason == "not_verified"
    assert not record.meta["events"]
    lasted = Unsure.looks[-1] - Unsure.looks[0]
    assert lasted == pytest.approx(margins.ARM.longest_last_look, abs=0.01)
    figures = result(push.task, push, record)
    assert (figures["success"], figures["verified"]) == (True, False)


def test_what_seems_to_have_missed_is_looked_at_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    push = plan(load_task("rear-push-left", [*PERIODIC, "motion.recoveries=0"]))
    record = run(push, 10_000, monkeypatch, Off)
    assert record.reason == "not_verified"
    lasted = Unsure.looks[-1] - Unsure.looks[0]
    assert lasted == pytest.approx(margins.ARM.longest_look, abs=0.01)


@pytest.mark.parametrize(
    ("unsure", "reason"), [(1, "goal_reached"), (2, "not_verified")]
)
def test_what_is_seen_well_but_is_not_surely_there_is_moved_once_more(
    unsure: int, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    changes = [*PERIODIC, f"tolerance.position={TOLERANCE}"]
    push = plan(load_task("rear-push-left", changes))
    monkeypatch.setattr(Beside, "made", 0)
    monkeypatch.setattr(Beside, "unsure", unsure)
    record = run_loop(planar_cell(push), push, RunOptions(controller=Beside))
    (event,) = record.meta["events"]
    assert (event["code"], event["recovered"]) == ("not_verified", True)
    assert record.reason == reason


def test_a_look_before_another_attempt_does_not_count(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    changes = [*PERIODIC, f"tolerance.position={TOLERANCE}"]
    push = plan(load_task("rear-push-left", changes))
    monkeypatch.setattr(Beside, "made", 0)
    cell = planar_cell(push)
    loop = RunLoop(cell, push, RunOptions(controller=Beside))
    with cell.connected():
        while not loop.events:
            assert loop.step() is None
    assert loop.last_look is None
    lost = loop.record(Ending("contact_lost"))
    assert result(push.task, push, lost)["success"] is False


class Stamped(Controller):
    """A controller that writes down when the tips let go, and when the object was last
    seen.
    """

    stamps: ClassVar[list[tuple[float, float]]] = []

    def last_look(self, state: ControllerState) -> LastLook:
        seen = state.estimate.time - state.estimate.age
        self.stamps.append((state.phase.since, seen))
        return super().last_look(state)


def test_a_goal_is_verified_by_a_picture_from_after_the_tips_let_go(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Stamped, "stamps", [])
    slow = ["sensing.pose_rate=1.0", "sensing.pose_delay=1.0"]
    push = plan(load_task("rear-push-left", slow))
    record = run_loop(planar_cell(push), push, RunOptions(controller=Stamped))
    assert record.reason == "goal_reached"
    released, seen = Stamped.stamps[-1]
    assert seen >= released + LETTING_GO
