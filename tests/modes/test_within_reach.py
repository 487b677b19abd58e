"""Two pushes in a search: only placements within the arms' reach are evaluated."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from pushpressslide import load_task
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes import MODES, orthogonal_push
from pushpressslide.modes.base import Feasibility
from pushpressslide.modes.shared.twist_pushes import within_reach
from pushpressslide.planning.face_placements import on_two_faces, side_by_side
from pushpressslide.planning.side_contacts import contact_height, pushable

SHIPPED = load_task("orthogonal-push")
SEARCHED = replace(SHIPPED.query, from_search=True)
FAR = Pose2(1.6, 0.0, 0.0)


def beyond(query: MotionQuery) -> MotionQuery:
    """Return a query with start and goal out of reach."""
    return query.between(FAR, FAR.compose(Pose2(0.1, 0.02, 0.1)))


@pytest.mark.parametrize("mode", ["orthogonal_push", "parallel_push"])
def test_out_of_reach_nothing_is_worked_out(
    mode: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(orthogonal_push, "push_surface", None)
    choices = MODES[mode].choices(beyond(SEARCHED), 2)
    assert {c.refusal.code for c in choices if c.refusal} <= {"reach", "offset_contact"}
    assert not any(choice.feasible for choice in choices)
    monkeypatch.setattr(orthogonal_push, "push_surface", push_surface)
    alone = MODES[mode].choices(beyond(SHIPPED.query), 2)
    assert any(choice.segments for choice in alone)


def test_what_is_left_is_what_two_arms_reach_one_each() -> None:
    scene = SEARCHED.scene
    height = contact_height(scene, SEARCHED.motion)
    faces = [face for face in pushable(scene, 0.04) if face.flat]
    placements = []
    for face, other in pairwise((*faces, faces[0])):
        placements += side_by_side(scene, face, height)
        placements += on_two_faces(scene, (face, other), height)
    feasibility = Feasibility(SEARCHED)
    left = within_reach(SEARCHED, placements)
    assert 0 < len(left) < len(placements)
    for a, b in placements:
        either = any(
            feasibility.reach_ends(replace(a, arm=i))
            and feasibility.reach_ends(replace(b, arm=1 - i))
            for i in (0, 1)
        )
        assert ((a, b) in left) == either
    assert within_reach(SHIPPED.query, placements) == placements
