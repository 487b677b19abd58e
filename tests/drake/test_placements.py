"""Joint paths of placements, one after the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths import placements
from pushpressslide.arms.paths.placements import PlacementPaths
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.robots.tool import UPRIGHT
from pushpressslide.sim.arm_library import DRAKE, joint_paths_of

PLAN = pps.plan(pps.load_task("rear-push-rear"))
(SEGMENT,) = PLAN.segments
FIRST = Plan(PLAN.task, (SEGMENT,))
THEN = Plan(PLAN.task, (replace(SEGMENT, leg=1),))
(CONTACT,) = PLAN.contacts
ELSEWHERE = replace(CONTACT, point=(CONTACT.point[0], CONTACT.point[1] + 0.01))
OTHER = Plan(PLAN.task, (replace(SEGMENT, contacts=(ELSEWHERE,)),))
STILL = np.zeros((2, 7))
PATH = JointPath(np.arange(2.0), STILL, np.arange(2.0), STILL, 0.0, 1.0, 1.0, 1.0, 0.05)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Plan]:
    """The plans that joint paths were asked for."""
    plans: list[Plan] = []

    def joint_paths(library, plan, *, force, postures, holding):
        plans.append(plan)
        return ((PATH, UPRIGHT),)

    def drawn_back(paths, holding):
        return (STILL[0],)

    monkeypatch.setattr(placements, "joint_paths", joint_paths)
    monkeypatch.setattr(placements, "drawn_back", drawn_back)
    return plans


@pytest.mark.parametrize(
    "parts", [(FIRST, THEN), (FIRST, OTHER), (FIRST, OTHER, THEN), (FIRST, THEN, OTHER)]
)
def test_there_are_joint_paths_for_each_placement_of_the_whole_plan(
    asked: list[Plan], parts: tuple[Plan, ...]
) -> None:
    preparation = PlacementPaths(DRAKE, force=True)
    for part in parts:
        preparation.add(part)
    segments = tuple(segment for part in parts for segment in part.segments)
    whole = Plan(PLAN.task, segments)
    assert len(preparation.paths) == len(whole.placements)
    assert tuple(made.segments for made in preparation.plans) == whole.placements
    assert len(joint_paths_of(whole)) == len(whole.placements)


def test_a_placement_without_a_joint_path_changes_nothing(
    asked: list[Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    preparation = PlacementPaths(DRAKE)
    preparation.add(FIRST)

    def refuse(*args, **options):
        raise InfeasibleTaskError("robots: no joint path")

    monkeypatch.setattr(placements, "joint_paths", refuse)
    for part in (THEN, OTHER):
        with pytest.raises(InfeasibleTaskError):
            preparation.add(part)
    assert preparation.plans == [FIRST]
    assert preparation.paths == [((PATH, UPRIGHT),)]
