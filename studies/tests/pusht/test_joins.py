"""Three pushes join two poses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.planning.dubins import candidates
from pushpressslide_studies.pusht.joins import contacts, joins
from pushpressslide_studies.pusht.pushes import final_pose
from pushpressslide_studies.pusht.tee import FACES, GOAL_BODY

place = st.floats(100.0, 400.0)
pose = st.builds(Pose2, place, place, st.floats(-math.pi, math.pi))


@given(start=pose, goal=pose, seed=st.integers(0, 10**6))
def test_every_join_ends_at_its_goal(start: Pose2, goal: Pose2, seed: int) -> None:
    found = joins(start, goal)
    assert len(found.triples) > 1000
    for index in np.random.default_rng(seed).integers(len(found.triples), size=20):
        triple = found.triples[index].tolist()
        pushes = map(contacts().push, triple, found.lengths[index].tolist())
        end = final_pose(start, pushes)
        # rounding: the radius of a push that counts as straight is 12,000 px
        assert end.position == pytest.approx(goal.position, abs=0.01)
        assert wrap_angle(end.yaw - goal.yaw) == pytest.approx(0.0, abs=1e-6)


def test_no_push_is_backwards_or_turns_by_a_full_turn() -> None:
    found = joins(Pose2(150.0, 200.0, 2.0), GOAL_BODY)
    turns = found.lengths * np.abs(contacts().curvatures[found.triples])
    assert found.lengths.min() >= 0.0
    assert turns.max() <= 2.0 * math.pi


def test_joins_on_one_face_are_the_words_of_three_arcs() -> None:
    tried = contacts()
    on_bar = np.flatnonzero(tried.faces == 0)
    turn_left = on_bar[np.argmin(tried.lefts[on_bar])]
    turn_right = on_bar[np.argmax(tried.lefts[on_bar])]
    start = Pose2(200.0, 250.0, 0.3)
    found = joins(start, GOAL_BODY)
    car = dict(zip(("L", "R"), (turn_left, turn_right), strict=True))
    bend = float(tried.curvatures[turn_left])
    nx, ny = FACES[0].normal
    heading = Pose2(0.0, 0.0, math.atan2(ny, nx))
    ends = (start.compose(heading), GOAL_BODY.compose(heading))
    words = [
        (word, path)
        for word, path in candidates(*ends, bend, bend)
        if "S" not in word and len(path.sections) == 3
    ]
    assert words
    for word, path in words:
        triple = [car[letter] for letter in word]
        lengths = found.lengths[(found.triples == triple).all(1)]
        planned = [length for _, length in path.sections]
        assert np.abs(lengths - planned).max(1).min() < 1e-6
