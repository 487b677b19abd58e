"""Object poses from another source: late, infrequent, from another thread."""

from __future__ import annotations

import threading
from collections import deque
from queue import Empty, SimpleQueue

import pytest

import pushpressslide as pps
from pushpressslide.control.estimator import (
    Estimate,
    EstimatorState,
    ObjectEstimator,
    Observation,
)
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.control.tracker import ObjectTracker, StampedPose
from pushpressslide.planar.cell import planar_cell

AGE = 0.05  # [s] of a pose when it comes
TASK = pps.load_task("rear-push-rear")
PLAN = pps.plan(TASK)


class Late:
    """Poses that a camera sees every few ticks and that come later."""

    def __init__(self, camera: ObjectTracker, every: int = 1) -> None:
        self.camera = camera
        self.every = every
        self.seen: deque[StampedPose] = deque()
        self.count = 0

    def read(self) -> StampedPose | None:
        picture = self.camera.read()
        assert picture is not None
        if self.count % self.every == 0:
            self.seen.append(picture)
        self.count += 1
        if self.seen and self.seen[0].time <= picture.time - AGE + 1e-9:
            return self.seen.popleft()
        return None


@pytest.mark.parametrize("every", [1, 8])
def test_a_task_is_done_by_poses_that_are_old_when_they_come(every: int) -> None:
    """Eight ticks of 4 ms: 31 pictures a second."""
    ages = []

    class Noting(ObjectEstimator):
        def step(
            self, state: EstimatorState, observation: Observation
        ) -> tuple[Estimate, EstimatorState]:
            estimate, state = super().step(state, observation)
            ages.append(estimate.age)
            return estimate, state

    options = RunOptions(tracker=lambda own: Late(own, every), estimator=Noting)
    record = run_loop(planar_cell(PLAN), PLAN, options)
    figures = pps.result(record)
    assert figures["success"], figures["reason"]
    assert figures["final_position_error"] < 3e-3
    period = TASK.motion.control_period
    # after the first one has come, each is as old as it came, or waits for the next
    assert min(ages[50:]) == pytest.approx(AGE, abs=period)
    assert max(ages[50:]) == pytest.approx(AGE + (every - 1) * period, abs=period)


def test_poses_may_come_from_another_thread() -> None:
    """One that forwards what it sees, whenever it is its turn."""
    cell = planar_cell(PLAN)
    pictures: SimpleQueue[StampedPose | None] = SimpleQueue()
    sent: SimpleQueue[StampedPose] = SimpleQueue()

    def forward() -> None:
        while (picture := pictures.get()) is not None:
            sent.put(picture)

    class Newest:
        def __init__(self, camera: ObjectTracker) -> None:
            self.camera = camera

        def read(self) -> StampedPose | None:
            newest = None
            pictures.put(self.camera.read())
            try:
                while True:
                    newest = sent.get_nowait()
            except Empty:
                return newest

    worker = threading.Thread(target=forward)
    worker.start()
    try:
        record = run_loop(cell, PLAN, RunOptions(tracker=Newest))
    finally:
        pictures.put(None)
        worker.join()
    assert pps.result(record)["success"]


def test_an_object_that_nobody_has_seen_is_where_the_plan_begins() -> None:
    class Blind:
        def read(self) -> None:
            return None

    first = []

    class Looking(ObjectEstimator):
        def start(self, pose: StampedPose) -> EstimatorState:
            first.append(pose)
            return super().start(pose)

    options = RunOptions(
        tracker=lambda own: Blind(), estimator=Looking, stop=lambda: bool(first)
    )
    run_loop(planar_cell(PLAN), PLAN, options)
    assert first == [StampedPose(0.0, TASK.start)]
