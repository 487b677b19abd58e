"""Planning past a post: problems that need it, and plans that avoid it."""

import importlib.util
from itertools import islice

import pytest

from pushpressslide.selection.solve import plan
from pushpressslide.selection.waypoints import free_space
from pushpressslide_studies.bench import planners


def test_in_each_problem_the_post_is_in_the_way_and_the_plan_keeps_off_it() -> None:
    for task in islice(planners.problems(3), 3):
        space = free_space(task.query)
        assert not space.straight(task.start, task.goal)
        made = plan(task)
        poses = [
            made.object_pose(piece, share * piece.path.length)
            for piece in made.segments
            for share in (0.0, 0.25, 0.5, 0.75, 1.0)
        ]
        assert space.free(poses).all()
        assert {piece.mode for piece in made.segments} == {planners.MODE}


def test_problems_are_the_same_for_a_seed() -> None:
    first, second, other = (next(planners.problems(seed)).start for seed in (5, 5, 6))
    assert first == second != other


def test_rows_say_what_was_planned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planners, "PROBLEMS", 2)
    monkeypatch.setattr(planners, "PATIENCE", 2.0)
    monkeypatch.setattr(planners, "PLANNERS", ("RRTConnect",))
    ours, theirs = planners.planners(0)
    assert ours["of"] == 2
    assert ours["planned"] == 2
    assert ours["takes_s"] >= ours["way_m"] / 0.05
    if importlib.util.find_spec("ompl") is None:
        assert "pushpressslide-studies[bench]" in theirs["note"]
        return
    assert theirs["of"] == 2
    assert theirs["checks"] > 0
