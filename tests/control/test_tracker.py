"""Poses of the object that come from elsewhere: late, seldom, from another thread."""

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
    StampedPose,
)
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.core.control import Measurement
from pushpressslide.planar.plant import PlanarPlant

AGE = 0.05  # [s] of a pose when it comes
TASK = pps.load_task("rear-push-rear")
PLAN = pps.plan(TASK)


class Watched(PlanarPlant):
    """The planar engine, before a camera that sees the object at every tick."""

    def __init__(self, plan: pps.Plan) -> None:
        super().__init__(plan)
        self.pictures: SimpleQueue[StampedPose | None] = SimpleQueue()

    def measure(self) -> Measurement:
        truth = super().measure()
        self.pictures.put(StampedPose(truth.time, truth.object_pose))
        return truth


class Late:
    """Poses that are seen every few ticks and come later."""

    def __init__(self, plant: Watched, every: int = 1) -> None:
        self.plant = plant
        self.every = every
        self.seen: deque[StampedPose] = deque()
        self.count = 0

    def read(self) -> StampedPose | None:
        picture = self.plant.pictures.get()
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

    plant = Watched(PLAN)
    options = RunOptions(tracker=Late(plant, every), estimator=Noting)
    record = run_loop(plant, PLAN, options)
    figures = pps.result(record)
    assert figures["success"], figures["reason"]
    assert figures["final_position_error"] < 3e-3
    period = TASK.motion.control_period
    # after the first one has come, each is as old as it came, or waits for the next
    assert min(ages[50:]) == pytest.approx(AGE, abs=period)
    assert max(ages[50:]) == pytest.approx(AGE + (every - 1) * period, abs=period)


def test_poses_may_come_from_another_thread() -> None:
    """One that forwards what it sees, whenever it is its turn."""
    plant = Watched(PLAN)
    sent: SimpleQueue[StampedPose] = SimpleQueue()

    def forward() -> None:
        while (picture := plant.pictures.get()) is not None:
            sent.put(picture)

    class Newest:
        def read(self) -> StampedPose | None:
            newest = None
            try:
                while True:
                    newest = sent.get_nowait()
            except Empty:
                return newest

    worker = threading.Thread(target=forward)
    worker.start()
    try:
        record = run_loop(plant, PLAN, RunOptions(tracker=Newest()))
    finally:
        plant.pictures.put(None)
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

    options = RunOptions(tracker=Blind(), estimator=Looking, stop=lambda: bool(first))
    run_loop(PlanarPlant(PLAN), PLAN, options)
    assert first == [StampedPose(0.0, TASK.start)]
