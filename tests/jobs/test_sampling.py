"""Random tasks are within the published ranges, with goals that their mode can reach."""

import ast
import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from pushpressslide.core.errors import PushPressSlideError, TaskError
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.jobs import sampling
from pushpressslide.jobs.sampling import (
    AHEAD,
    AZIMUTH,
    DISTANCE,
    ONE_ARM_REACH,
    TOP_CONTACT_EDGE,
    TWO_ARM_REACH,
    random_task,
    uncertain_task,
)
from pushpressslide.jobs.sweep import SweepOptions, sample_task, sweep
from pushpressslide.mechanics.top import inside_top
from pushpressslide.modes import MODES
from pushpressslide.taskfile.load import load_task

TURNS = {"parallel-push": 35.0, "orthogonal-push": 35.0, "bimanual-slide": 60.0}
HEIGHTS = {
    "parallel-push": (0.1, 0.22),
    "orthogonal-push": (0.1, 0.22),
    "bimanual-slide": (0.05, 0.15),
}
BASES = {name: load_task(name) for name in TURNS}
ONE_ARM = ("press-slide", "rear-push-rear")
ANY = (*ONE_ARM, "parallel-push", "bimanual-slide")


@cache
def drawn(name: str, count: int = 60, draw: sampling.Draw = "ahead") -> list[Task]:
    base = load_task(name)
    return [random_task(base, i, 3, draw) for i in range(count)]


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
    for task in drawn(name):
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
                assert (
                    TWO_ARM_REACH[0]
                    <= math.dist(place, robot.base[:2])
                    <= TWO_ARM_REACH[1]
                )
        assert task.full_belief.mass == task.object.mass


def test_tasks_for_one_of_two_arms_are_drawn_about_either() -> None:
    cell = replace(BASES["parallel-push"], modes=("rear_push", "press_slide"))
    bases = [robot.base[:2] for robot in cell.robots]
    nearer = set()
    for i in range(20):
        task = random_task(cell, i, 3)
        reached = []
        for base in bases:
            far = [math.dist(place, base) for place in centers(task)]
            reached.append(
                ONE_ARM_REACH[0] <= min(far) and max(far) <= ONE_ARM_REACH[1]
            )
        assert any(reached)
        nearer.add(reached.index(True))
    assert nearer == {0, 1}


def test_tasks_for_all_modes_of_two_arms_are_drawn_for_both() -> None:
    free = replace(BASES["parallel-push"], modes=None)
    both = ("parallel_push", "orthogonal_push", "bimanual_press_slide")
    named = replace(free, modes=both)
    for i in range(5):
        assert replace(random_task(free, i, 3), modes=both) == random_task(named, i, 3)


@pytest.mark.parametrize("name", ["parallel-push", "orthogonal-push"])
def test_a_push_goes_ahead_and_away_from_the_robots(name: str) -> None:
    for task in drawn(name):
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
    tasks = drawn("bimanual-slide")
    assert any(isinstance(task.object.shape, Cylinder) for task in tasks)
    back = [task for task in tasks if task.goal.x < task.start.x - 0.05]
    assert len(back) > 10


def test_a_draw_depends_on_seed_and_index_alone() -> None:
    base = BASES["orthogonal-push"]
    options = SweepOptions(vary="tasks", seed=1)
    assert sample_task(base, options, 5) == random_task(base, 5, 1)
    assert random_task(base, 5, 1) != random_task(base, 5, 2)
    assert random_task(base, 5, 1) != random_task(base, 6, 1)


def test_other_modes_are_refused_before_anything_runs(tmp_path: Path) -> None:
    task = replace(BASES["orthogonal-push"], modes=("press_and_push",))
    with pytest.raises(
        TaskError, match=r"modes: \['press_and_push'\] is not allowed.*parallel_push"
    ):
        sweep(task, SweepOptions(2, vary="tasks", engine="planar"), tmp_path)
    assert not (tmp_path / "result.json").exists()


def test_a_sweep_draws_for_the_mode_and_goes_on_where_it_was(tmp_path: Path) -> None:
    base = BASES["bimanual-slide"]
    options = SweepOptions(2, vary="tasks", seed=1, engine="planar", jobs=1)
    counts = []
    first = sweep(base, options, tmp_path)
    again = sweep(
        base, options, tmp_path, progress=lambda done, total: counts.append(done)
    )
    assert first["attempted"] == first["reached"] == 2
    assert again == first
    assert counts == []
    rows = (tmp_path / "rows.jsonl").read_text().splitlines()
    names = {json.loads(row)["task"] for row in rows}
    assert names == {"bimanual-slide-random-1-000", "bimanual-slide-random-1-001"}


@pytest.mark.parametrize("name", ONE_ARM)
def test_one_arm_gets_starts_and_goals_within_its_reach(name: str) -> None:
    for task in drawn(name, 80):
        (robot,) = task.robots
        assert 0.3 <= task.object.mass <= 3.0
        assert 0.2 <= task.support.friction <= 0.5
        assert 0.4 <= task.contact_friction <= 1.0
        for pose in (task.start, task.goal):
            dx = pose.x - robot.base[0]
            dy = pose.y - robot.base[1]
            azimuth = math.remainder(math.atan2(dy, dx) - robot.base_yaw, 2.0 * math.pi)
            assert ONE_ARM_REACH[0] <= math.hypot(dx, dy) <= ONE_ARM_REACH[1]
            assert abs(azimuth) <= AZIMUTH
            assert abs(pose.yaw) <= math.pi
        ahead, left = task.start.unapply(task.goal.position)
        assert DISTANCE[0] - 1e-9 <= math.hypot(ahead, left) <= DISTANCE[1] + 1e-9
        assert abs(math.degrees(math.atan2(left, ahead))) <= 25.0 + 1e-6


def test_only_pressed_objects_are_round_or_have_a_given_contact() -> None:
    def marked(task: Task) -> tuple[bool, bool]:
        return isinstance(task.object.shape, Cylinder), bool(task.motion.contacts)

    round_pressed, given = zip(*map(marked, drawn("press-slide", 80)), strict=True)
    assert any(round_pressed)
    assert 0.1 < sum(given) / len(given) < 0.4
    assert all(marked(task) == (False, False) for task in drawn("rear-push-rear", 80))


def test_a_given_contact_is_inside_the_top() -> None:
    for task in drawn("press-slide", 80):
        for x, y in task.motion.contacts or ():
            cx, cy = task.object.center_of_mass
            place = (x - cx, y - cy)
            assert 0.02 <= math.hypot(*place) <= 0.1
            assert inside_top(task.object, place, TOP_CONTACT_EDGE)


def test_without_one_mode_tasks_of_all_kinds_are_drawn() -> None:
    for name, kinds in (("press-slide", 2), ("parallel-push", 3)):
        free = replace(load_task(name), modes=None)
        tasks = [random_task(free, i, 3) for i in range(60)]
        assert tasks == [random_task(free, i, 3) for i in range(60)]
        heights = {task.object.shape.height for task in tasks}
        assert len(heights) == 60
        pressed = sum(isinstance(task.object.shape, Cylinder) for task in tasks)
        assert 0 < pressed < 60 / kinds


@pytest.mark.parametrize("name", ANY)
def test_goals_of_any_draw_lie_in_all_directions(name: str) -> None:
    quadrants = set()
    for task in drawn(name, 80, "any"):
        x, y = task.start.unapply(task.goal.position)
        quadrants.add((x > 0.0, y > 0.0))
    assert len(quadrants) == 4


@pytest.mark.parametrize("name", ANY)
def test_objects_of_any_draw_are_small_and_large_and_off_centre(name: str) -> None:
    arms = len(load_task(name).robots)
    low, high = sampling.ANY_SIZE[arms]
    sizes = [
        max(2.0 * task.object.shape.half_width, low) for task in drawn(name, 80, "any")
    ]
    assert min(sizes) < 2.5 * low
    assert max(sizes) > 0.5 * high
    off = 0
    for task in drawn(name, 80, "any"):
        body = task.object
        assert body.shape.depth(body.center_of_mass) > 0.0
        off += math.dist(body.center_of_mass, body.shape.centroid) > 1e-3
        least, most = sampling.ANY_MASS[arms]
        assert least <= body.mass <= most
    assert off > 40


@pytest.mark.parametrize("name", ANY)
def test_nothing_is_drawn_over_a_base(name: str) -> None:
    for task in drawn(name, 80, "any"):
        for robot in task.robots:
            for pose in (task.start, task.goal):
                base = pose.unapply(robot.base[:2])
                assert task.object.shape.distance(base) >= sampling.BASE_ROOM


def test_a_draw_that_finds_nothing_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "ONE_ARM_REACH", (0.5, 0.5))
    monkeypatch.setattr(sampling, "TRIES", 50)
    with pytest.raises(PushPressSlideError, match="in 50 draws"):
        random_task(load_task("rear-push-rear"), 0, 3)


def test_an_uncertain_world_differs_from_what_is_believed() -> None:
    known = random_task(load_task("press-slide"), 2, 3)
    uncertain = uncertain_task(known, 2, 3)
    assert uncertain.full_belief.support_friction == known.support.friction
    assert uncertain.full_belief.mass == known.object.mass
    ratio = uncertain.support.friction / known.support.friction
    assert 0.8 <= ratio <= 1.2
    assert ratio != 1.0
    off = math.dist(uncertain.object.center_of_mass, known.object.center_of_mass)
    assert 0.0 < off <= 0.01
    assert uncertain.sensing.delay == 0.02


def test_sampling_knows_no_mode_by_name() -> None:
    tree = ast.parse(Path(sampling.__file__).read_text(encoding="utf-8"))
    texts = {
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    assert not texts & set(MODES)
