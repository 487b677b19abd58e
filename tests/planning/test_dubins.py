"""Dubins paths: against OMPL, against a brute-force search, and their symmetries."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.planning.dubins import candidates, shortest_path

poses = st.builds(
    Pose2, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-math.pi, math.pi)
)
curvatures = st.floats(0.2, 5.0)


def off_the_jump(start: Pose2, goal: Pose2) -> bool:
    """The length jumps by a turn where a goal at the start comes off the straight line:
    round-off decides.
    """
    return math.hypot(goal.x - start.x, goal.y - start.y) > 1e-3


def reaches(path: ArcPath, goal: Pose2) -> bool:
    end = path.end
    return (
        math.hypot(end.x - goal.x, end.y - goal.y) < 1e-9
        and abs(wrap_angle(end.yaw - goal.yaw)) < 1e-9
    )


def random_pose(generator, size: float) -> Pose2:
    x, y, yaw = generator.uniform(-1.0, 1.0, 3)
    return Pose2(size * x, size * y, math.pi * yaw)


def test_ten_thousand_shortest_paths_are_as_long_as_ompls():
    base = pytest.importorskip("ompl.base")
    generator = np.random.default_rng(0)
    for radius in (0.5, 1.0, 3.0):
        space = base.DubinsStateSpace(radius)
        a = space.allocState()
        b = space.allocState()
        for _ in range(3500):
            start = random_pose(generator, 4.0)
            goal = random_pose(generator, 4.0)
            for state, pose in ((a, start), (b, goal)):
                state.setXY(pose.x, pose.y)
                state.setYaw(pose.yaw)
            path = shortest_path(start, goal, 1.0 / radius, 1.0 / radius)
            assert path.length == pytest.approx(space.distance(a, b), abs=1e-9)


@settings(max_examples=300)
@given(poses, poses, curvatures, curvatures)
def test_every_candidate_reaches_the_goal_within_the_limits_and_is_sorted(
    start, goal, left, right
):
    paths = candidates(start, goal, left, right)
    lengths = [path.length for _, path in paths]
    assert lengths == pytest.approx(sorted(lengths), abs=1e-9)
    assert shortest_path(start, goal, left, right).length == pytest.approx(
        lengths[0], abs=1e-9
    )
    assert {"LSL", "RSR"} <= {word for word, _ in paths}
    for word, path in paths:
        assert reaches(path, goal), word
        signs = {"L": left, "S": 0.0, "R": -right}
        allowed = iter([signs[letter] for letter in word])
        assert all(any(k == c for c in allowed) for k, _ in path.sections), (
            "pieces follow the word's order"
        )
        assert all(length > 0.0 for _, length in path.sections)


@given(poses, st.floats(1e-9, 1e-5), st.sampled_from(["S", "L", "R"]))
def test_a_tiny_way_is_no_whole_circle(start, length, letter):
    bent = {"S": 0.0, "L": 2.0, "R": -3.0}
    path = ArcPath(start, ((bent[letter], length),))
    assert shortest_path(start, path.end, 2.0, 3.0).length <= length + 1e-8


@settings(max_examples=400)
@given(
    poses,
    curvatures,
    curvatures,
    st.lists(
        st.tuples(st.floats(-1.0, 1.0), st.floats(0.0, 3.0)), min_size=1, max_size=6
    ),
)
def test_no_path_within_the_limits_is_shorter(start, left, right, steps):
    pieces = tuple((c * left if c > 0.0 else c * right, length) for c, length in steps)
    path = ArcPath(start, pieces)
    assert shortest_path(start, path.end, left, right).length <= path.length + 1e-8


@settings(max_examples=300)
@given(
    poses,
    curvatures,
    curvatures,
    st.sampled_from(["LSL", "LSR", "RSL", "RSR", "LRL", "RLR"]),
    st.tuples(st.floats(0.05, 6.2), st.floats(0.05, 6.2), st.floats(0.05, 6.2)),
)
def test_no_word_driven_forward_beats_the_shortest(start, left, right, word, amounts):
    made = {"L": (left, 1.0 / left), "S": (0.0, 1.0), "R": (-right, 1.0 / right)}
    pieces = tuple(
        (made[w][0], made[w][1] * a) for w, a in zip(word, amounts, strict=True)
    )
    path = ArcPath(start, pieces)
    assert shortest_path(start, path.end, left, right).length <= path.length + 1e-8
    same = [
        p.length for name, p in candidates(start, path.end, left, right) if name == word
    ]
    assert min(same) <= path.length + 1e-8


def searched_length(goal: Pose2, left: float, right: float) -> float:
    """Return the least length of the six words from the origin, found by scanning the
    first arc.

    For each first arc the last turning circle is known from the goal, and one residual
    remains: the straight piece must touch that circle, or the middle circle must. Its
    sign changes are refined by bisection.
    """
    # signed: the centre is this far to the left
    radius = {"L": 1.0 / left, "R": -1.0 / right}

    def after(letter, t):
        r = radius[letter]
        yaw = t * np.sign(r)
        return r * np.sin(yaw), r - r * np.cos(yaw), yaw

    def completed(word, t):
        """Return residual and total length (inf where the middle piece would run
        backward).
        """
        r0 = radius[word[0]]
        r2 = radius[word[2]]
        x, y, yaw = after(word[0], t)
        cx = goal.x - r2 * math.sin(goal.yaw)
        cy = goal.y + r2 * math.cos(goal.yaw)
        if word[1] == "S":
            dx = cx - x
            dy = cy - y
            along = dx * np.cos(yaw) + dy * np.sin(yaw)
            residual = -dx * np.sin(yaw) + dy * np.cos(yaw) - r2
            last = np.mod((goal.yaw - yaw) * np.sign(r2), 2 * math.pi)
            return residual, np.where(
                along >= 0.0, t * abs(r0) + along + last * abs(r2), np.inf
            )
        r1 = radius[word[1]]
        mx = x - r1 * np.sin(yaw)
        my = y + r1 * np.cos(yaw)
        residual = np.hypot(cx - mx, cy - my) - (abs(r1) + abs(r2))
        # Heading at the touching point: across the line of centres, in the sense of the
        # middle turn.
        bearing = np.arctan2(cy - my, cx - mx)
        touch = bearing + np.sign(r1) * 0.5 * math.pi
        middle = np.mod((touch - yaw) * np.sign(r1), 2 * math.pi)
        last = np.mod((goal.yaw - touch) * np.sign(r2), 2 * math.pi)
        return residual, t * abs(r0) + middle * abs(r1) + last * abs(r2)

    best = math.inf
    grid = np.linspace(0.0, 2 * math.pi, 1501)
    for word in ("LSL", "LSR", "RSL", "RSR", "LRL", "RLR"):
        residual, _ = completed(word, grid)
        crossing = np.nonzero(np.signbit(residual[:-1]) != np.signbit(residual[1:]))[0]
        if not len(crossing):
            continue
        low = grid[crossing]
        high = grid[crossing + 1]
        sign = np.signbit(residual[crossing])
        for _ in range(50):
            half = 0.5 * (low + high)
            same = np.signbit(completed(word, half)[0]) == sign
            low = np.where(same, half, low)
            high = np.where(same, high, half)
        best = min(best, float(completed(word, 0.5 * (low + high))[1].min()))
    return best


def test_with_unequal_limits_the_shortest_is_the_one_that_a_search_finds():
    generator = np.random.default_rng(5)
    words = set()
    for i in range(400):
        goal = random_pose(generator, 3.0 if i % 2 else 1.2)
        left, right = generator.uniform(0.3, 3.0, 2)
        ours = shortest_path(Pose2(), goal, left, right)
        assert ours.length == pytest.approx(
            searched_length(goal, left, right), abs=1e-7
        )
        words.add(candidates(Pose2(), goal, left, right)[0][0])
    assert words == {"LSL", "LSR", "RSL", "RSR", "LRL", "RLR"}


def test_with_unequal_limits_least_squares_from_many_starts_finds_nothing_shorter():
    from scipy.optimize import least_squares

    generator = np.random.default_rng(7)
    for _ in range(6):
        goal = random_pose(generator, 1.5)
        left, right = generator.uniform(0.4, 2.0, 2)
        shortest = shortest_path(Pose2(), goal, left, right).length
        made = {"L": (left, 1.0 / left), "S": (0.0, 1.0), "R": (-right, 1.0 / right)}
        found = math.inf
        for word in ("LSL", "LSR", "RSL", "RSR", "LRL", "RLR"):

            def driven(a, word=word, made=made):
                return ArcPath(
                    Pose2(),
                    tuple(
                        (made[w][0], made[w][1] * v)
                        for w, v in zip(word, a, strict=True)
                    ),
                )

            def gap(a, driven=driven, goal=goal):
                end = driven(a).end
                return [
                    end.x - goal.x,
                    end.y - goal.y,
                    2.0 * math.sin(0.5 * (end.yaw - goal.yaw)),
                ]

            for start in generator.uniform(0.1, 6.0, (25, 3)):
                fit = least_squares(gap, start, bounds=(0.0, 12.0), max_nfev=60)
                if fit.cost < 1e-18:
                    found = min(found, driven(fit.x).length)
        assert shortest <= found + 1e-7
        assert shortest == pytest.approx(found, abs=1e-5)


@given(poses, poses, curvatures, curvatures)
def test_the_mirrored_task_with_the_limits_exchanged_is_as_long(
    start, goal, left, right
):
    mirrored = shortest_path(
        Pose2(start.x, -start.y, -start.yaw),
        Pose2(goal.x, -goal.y, -goal.yaw),
        right,
        left,
    )
    assert mirrored.length == pytest.approx(
        shortest_path(start, goal, left, right).length, abs=1e-8
    )


@given(poses, poses, curvatures, curvatures)
def test_the_way_back_turned_round_is_as_long_with_the_limits_exchanged(
    start, goal, left, right
):
    # Driving a path from its end, turned by half a turn, exchanges left and right.
    assume(off_the_jump(start, goal))
    back = shortest_path(
        Pose2(goal.x, goal.y, goal.yaw + math.pi),
        Pose2(start.x, start.y, start.yaw + math.pi),
        right,
        left,
    )
    assert back.length == pytest.approx(
        shortest_path(start, goal, left, right).length, abs=1e-8
    )


@given(poses, poses, curvatures, curvatures, st.floats(0.01, 100.0))
def test_scaling_lengths_scales_the_path(start, goal, left, right, scale):
    assume(off_the_jump(start, goal))
    path = shortest_path(start, goal, left, right)
    scaled = shortest_path(
        Pose2(scale * start.x, scale * start.y, start.yaw),
        Pose2(scale * goal.x, scale * goal.y, goal.yaw),
        left / scale,
        right / scale,
    )
    assert scaled.length == pytest.approx(
        scale * path.length, rel=1e-8, abs=1e-8 * scale
    )


@given(poses, poses, curvatures, curvatures, poses)
def test_the_path_moves_with_its_poses(start, goal, left, right, frame):
    assume(off_the_jump(start, goal))
    there = shortest_path(frame.compose(start), frame.compose(goal), left, right)
    assert there.length == pytest.approx(
        shortest_path(start, goal, left, right).length, abs=1e-8
    )
    assert there.length >= math.hypot(goal.x - start.x, goal.y - start.y) - 1e-9


@given(poses, curvatures, curvatures)
def test_from_a_pose_to_itself_there_is_nothing_to_drive(pose, left, right):
    path = shortest_path(pose, pose, left, right)
    assert path.sections == ()
    assert path.length == 0.0
    for dx, dy, turn in (
        (0.0, 0.0, 2.0 * math.pi),
        (1e-11, -1e-11, 1e-11),
        (-1e-11, 1e-11, -1e-11),
    ):
        near = Pose2(pose.x + dx, pose.y + dy, pose.yaw + turn)
        assert shortest_path(pose, near, left, right).length == 0.0


@given(poses, curvatures, curvatures, st.floats(0.01, 10.0))
def test_straight_ahead_is_straight(pose, left, right, distance):
    goal = pose.compose(Pose2(distance, 0.0, 0.0))
    path = shortest_path(pose, goal, left, right)
    assert path.length == pytest.approx(distance, abs=1e-9)
    assert reaches(path, goal)


@pytest.mark.parametrize("first", ["L", "R"])
@pytest.mark.parametrize(
    "angles", [(1.0, 2.0), (0.3, 0.3), (2.5, 0.0), (0.0, 1.2), (math.pi, 1e-7)]
)
def test_turning_circles_that_touch_are_found(first, angles):
    left = 2.0
    right = 0.7
    made = {"L": (left, 1.0 / left), "R": (-right, 1.0 / right)}
    second = "R" if first == "L" else "L"
    path = ArcPath(
        Pose2(0.4, -0.1, 0.8),
        tuple(
            (made[w][0], made[w][1] * a)
            for w, a in zip((first, second), angles, strict=True)
        ),
    )
    found = shortest_path(path.start, path.end, left, right)
    assert found.length <= path.length + 1e-6
    assert reaches(found, path.end)


def test_with_a_tie_the_answer_does_not_depend_on_round_off():
    # Straight behind, facing away: left and right round are equally long; left is
    # taken.
    for shift in (0.0, 1e-15, -1e-15):
        path = shortest_path(Pose2(), Pose2(-3.0, shift, math.pi), 1.0, 1.0)
        assert path.sections[0][0] == 1.0


@pytest.mark.parametrize(
    ("left", "right"), [(0.0, 1.0), (1.0, -0.2), (math.inf, 1.0), (1.0, math.nan)]
)
def test_limits_that_leave_no_turning_circle_are_refused(left, right):
    with pytest.raises(ValueError, match="finite and > 0"):
        shortest_path(Pose2(), Pose2(1.0, 0.0, 0.0), left, right)
    with pytest.raises(ValueError, match="must be finite"):
        shortest_path(Pose2(), Pose2(math.nan, 0.0, 0.0), 1.0, 1.0)
