"""Random tasks for two arms: within the published ranges, in a direction that the mode
can go.
"""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.jobs.sweep import sample_task, sweep
from pushpressslide.jobs.two_arm_sampling import (
    AHEAD,
    DISTANCE,
    REACH,
    random_two_arm_task,
)
from pushpressslide.taskfile.load import load_task

TURNS = {"parallel-push": 35.0, "orthogonal-push": 35.0, "bimanual-slide": 60.0}
HEIGHTS = {
    "parallel-push": (0.1, 0.22),
    "orthogonal-push": (0.1, 0.22),
    "bimanual-slide": (0.05, 0.15),
}
BASES = {name: load_task(name) for name in TURNS}
DRAWN = {
    name: [random_two_arm_task(base, i, 3) for i in range(60)]
    for name, base in BASES.items()
}


def centers(task: Task) -> list[tuple[float, float]]:
    return [pose.apply(task.object.center_of_mass) for pose in (task.start, task.goal)]


def normals(task: Task) -> list[float]:
    """Return the directions [rad] in the world in which the faces are pushed, at the
    start.
    """
    corners = [task.start.apply(corner) for corner in task.object.shape.corners]
    edges = zip(corners, (*corners[1:], corners[0]), strict=True)
    return [math.atan2(bx - ax, ay - by) for (ax, ay), (bx, by) in edges]


@pytest.mark.parametrize("name", TURNS)
def test_the_draws_are_within_what_is_published(name: str) -> None:
    for task in DRAWN[name]:
        start, goal = centers(task)
        assert 0.5 <= task.object.mass <= 4.0
        assert 0.2 <= task.support.friction <= 0.5
        assert 0.4 <= task.contact_friction <= 1.0
        assert HEIGHTS[name][0] <= task.object.shape.height <= HEIGHTS[name][1]
        assert DISTANCE[0] - 1e-9 <= math.dist(start, goal) <= DISTANCE[1] + 1e-9
        turn = math.remainder(task.goal.yaw - task.start.yaw, 2.0 * math.pi)
        assert abs(math.degrees(turn)) <= TURNS[name]
        for place in (start, goal):
            assert place[0] >= AHEAD  # the shipped bases are on the world's y axis
            for robot in task.robots:
                assert REACH[0] <= math.dist(place, robot.base[:2]) <= REACH[1]
        assert task.believed.mass == task.object.mass


@pytest.mark.parametrize("name", ["parallel-push", "orthogonal-push"])
def test_a_push_goes_ahead_and_away_from_the_robots(name: str) -> None:
    for task in DRAWN[name]:
        start, goal = centers(task)
        way = math.atan2(goal[1] - start[1], goal[0] - start[0])
        faces = normals(task)
        if name == "orthogonal-push":
            faces = [
                a + 0.5 * math.remainder(b - a, 2.0 * math.pi)
                for a, b in zip(faces, (*faces[1:], faces[0]), strict=True)
            ]
        pushed = [
            f
            for f in faces
            if abs(math.remainder(f, 2.0 * math.pi)) <= math.radians(30.0) + 1e-9
        ]
        off = min(abs(math.remainder(way - f, 2.0 * math.pi)) for f in pushed)
        assert math.degrees(off) <= 25.0 + 1e-6


def test_pressed_objects_are_of_all_kinds_and_go_any_way() -> None:
    tasks = DRAWN["bimanual-slide"]
    assert any(isinstance(task.object.shape, Cylinder) for task in tasks)
    back = [task for task in tasks if task.goal.x < task.start.x - 0.05]
    assert len(back) > 10


def test_a_draw_depends_on_seed_and_index_alone() -> None:
    base = BASES["orthogonal-push"]
    assert sample_task(base, "tasks", 5, 1) == random_two_arm_task(base, 5, 1)
    assert random_two_arm_task(base, 5, 1) != random_two_arm_task(base, 5, 2)
    assert random_two_arm_task(base, 5, 1) != random_two_arm_task(base, 6, 1)


def test_other_modes_are_refused_before_anything_runs(tmp_path: Path) -> None:
    task = replace(BASES["orthogonal-push"], modes=("press_and_push",))
    with pytest.raises(
        TaskError, match=r"modes: \['press_and_push'\] is not allowed.*parallel_push"
    ):
        sweep(task, samples=2, out=tmp_path, engine="planar", vary="tasks")
    assert not (tmp_path / "result.json").exists()


def test_a_sweep_draws_for_the_mode_and_goes_on_where_it_was(tmp_path: Path) -> None:
    base = BASES["bimanual-slide"]
    options = {"out": tmp_path, "engine": "planar", "jobs": 1}
    told = []
    first = sweep(base, samples=2, vary="tasks", seed=1, **options)
    again = sweep(
        base,
        samples=2,
        vary="tasks",
        seed=1,
        progress=lambda n, of: told.append(n),
        **options,
    )
    assert first["accepted"] == first["reached"] == 2
    assert again == first
    assert told == []
    names = {
        row["task"]
        for row in json.loads((tmp_path / "result.json").read_text())["rows"]
    }
    assert names == {"bimanual-slide-random-1-000", "bimanual-slide-random-1-001"}
