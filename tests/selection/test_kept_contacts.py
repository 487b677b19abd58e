"""A motion with kept contacts adds only its own time."""

import pytest

import pushpressslide as pps


def test_one_approach_and_one_release_are_expected_of_legs_without_a_new_grasp() -> (
    None
):
    task = pps.load_task("press-fit")
    choice = pps.select(task)[0]
    assert choice.feasible
    assert len(choice.segments) == len(task.legs)
    moving = sum(segment.profile.duration for segment in choice.segments)
    leg = pps.select(pps.load_task("bimanual-slide"))[0]
    around = leg.time - leg.segments[0].profile.duration
    assert choice.time - moving == pytest.approx(around, rel=0.3)


@pytest.mark.parametrize("name", ["any-mode", "press-fit"])
def test_a_choice_and_its_plan_cover_the_same_distance(name: str) -> None:
    task = pps.load_task(name)
    choice = pps.select(task)[0]
    plan = pps.plan(task, choice)
    covered = sum(segment.path.distance for segment in plan.segments)
    assert choice.path_length == pytest.approx(covered)
    if not task.legs:
        assert f"path {covered:.3f} m" in choice.reason
