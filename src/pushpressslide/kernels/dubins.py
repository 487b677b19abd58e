"""Shortest forward paths between two poses for a car whose left and right curvature
limits may differ.

Dubins (1957) solved the problem for equal limits. For unequal limits the shortest path
is one of the same six words (Bakolas and Tsiotras, "Optimal synthesis of the asymmetric
sinistral/dextral Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011): LSL, RSR,
LSR, RSL, RLR, LRL.
"""

from __future__ import annotations

from math import inf, isfinite, nan, pi, sqrt

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.elementary import (
    TURN,
    arccosine,
    arctangent2,
    cosine,
    hypotenuse,
    rounded_down,
    sine,
    turn_part,
)
from pushpressslide.kernels.kernel import compiled_as, kernel, kernel_wide

NONE = -1
LSL = 0
RSR = 1
LSR = 2
RSL = 3
RLR = 4
LRL = 5

# Angles [rad] this close to none or a full turn, and distances of this share of the
# radii, count as zero.
ROUND_OFF = 1e-12
# Poses this close, in radii and [rad], are one: next to the start the shortest length
# jumps by whole circles.
SAME_POSE = 5e-11
# Of the coordinates and radii: what rounding leaves unknown of where a centre is. A
# tangent along one of the headings but for that is along it: else a straight of 1e-8 m
# begins or ends with a whole circle.
BLUR = 1e-15

Pose = tuple[float, float, float]
Solution = tuple[float, int, float, float, float]
"""A path: length [m], word, first arc [rad], middle arc [rad] or line [m], last arc
[rad]. The length is infinite if there is no path.
"""
Circles = tuple[float, float, Vector, Vector, float, float]
"""Turning circles of both ends, relative to the start pose.

The members are the radii rl and rr [m] of left and right turns; the vectors [m] from
the start position to the goal's left and right centre; the yaw [rad] of the goal, NaN
for poses that are not finite; and the round-off [m] of the centres. The start's own
centres are (0, rl) and (0, -rr).
"""
Solutions = tuple[
    Solution, Solution, Solution, Solution, Solution, Solution, Solution, Solution
]


@kernel
def quick_full_turn(angle: float) -> float:
    """``full_turn``, as a single formula without branches."""
    angle = turn_part(angle)
    return angle if ROUND_OFF < angle < TURN - ROUND_OFF else 0.0


@compiled_as(quick_full_turn)
def full_turn(angle: float) -> float:
    """Angle [rad] in [0, 2 pi). Zero if it is a full turn, to within round-off."""
    if TURN <= angle < 2.0 * TURN:
        angle = angle - TURN
    elif -TURN < angle < 0.0:
        angle = angle + TURN
    elif not 0.0 <= angle < TURN:
        angle = turn_part(angle)  # the same, for many turns, at many times the cost
    if ROUND_OFF < angle < TURN - ROUND_OFF:
        return angle
    return 0.0


@kernel
def turning_circles(
    start: Pose, goal: Pose, kappa_left: float, kappa_right: float
) -> Circles:
    """Turning circles of two poses, for curvature limits [1/m] > 0."""
    rl = 1.0 / kappa_left
    rr = 1.0 / kappa_right
    yaw = goal[2] - start[2]
    dx = goal[0] - start[0]
    dy = goal[1] - start[1]
    if not (isfinite(yaw) and isfinite(dx) and isfinite(dy)):
        return rl, rr, (nan, nan), (nan, nan), nan, nan
    c = cosine(start[2])
    s = sine(start[2])
    x = c * dx + s * dy
    y = -s * dx + c * dy
    if hypotenuse(x, y) <= SAME_POSE * (rl + rr):
        off = turn_part(yaw)
        if off <= SAME_POSE or TURN - off <= SAME_POSE:
            x = 0.0
            y = 0.0
            yaw = 0.0
    s = sine(yaw)
    c = cosine(yaw)
    places = abs(start[0]) + abs(start[1]) + abs(goal[0]) + abs(goal[1])
    blur = BLUR * (places + rl + rr)
    return rl, rr, (x - rl * s, y + rl * c), (x + rr * s, y - rr * c), yaw, blur


@kernel
def dubins_solutions(circles: Circles) -> Solutions:
    """Paths of all words, in order. Words of three arcs occur twice, once for each
    position of the middle circle.
    """
    rl, rr, left, right, yaw, _ = circles
    both = rl + rr
    left_length, left_angle = centre_line(circles, left[0], left[1] - rl)
    right_length, right_angle = centre_line(circles, right[0], right[1] + rr)
    first = full_turn(left_angle)
    last = full_turn(yaw - left_angle)
    lsl = (left_length + rl * (first + last), LSL, first, left_length, last)
    first = full_turn(-right_angle)
    last = full_turn(right_angle - yaw)
    rsr = (right_length + rr * (first + last), RSR, first, right_length, last)
    opening = middle_opening(0.5 * right_length / both)
    rlr_1 = right_arcs(circles, right_angle, opening, opening)
    rlr_2 = right_arcs(circles, right_angle, -opening, opening)
    opening = middle_opening(0.5 * left_length / both)
    lrl_1 = left_arcs(circles, left_angle, opening, opening)
    lrl_2 = left_arcs(circles, left_angle, -opening, opening)
    lsr = left_right(circles)
    return lsl, rsr, lsr, right_left(circles), rlr_1, rlr_2, lrl_1, lrl_2


@kernel
def centre_line(circles: Circles, dx: float, dy: float) -> Vector:
    """Distance [m] and direction [rad] between two centres.

    For zero distance the direction is 0. If the direction equals one of the headings to
    within round-off, it is set to that heading.
    """
    length = hypotenuse(dx, dy)
    if not length > ROUND_OFF * (circles[0] + circles[1]):
        return length, 0.0
    angle = arctangent2(dy, dx)
    if abs(angle) * length <= circles[5]:
        return length, 0.0
    yaw = circles[4]
    past = angle - yaw
    past = past - TURN * rounded_down(past / TURN + 0.5)
    if abs(past) * length <= circles[5]:
        return length, yaw
    return length, angle


@kernel
def inner_tangent(dx: float, dy: float, both: float) -> Pose:
    """Length [m] of the inner tangent of two circles, direction [rad] of the line
    between their centres, and angle [rad] from that line to the tangent.

    The length is negative if there is no tangent. ``both`` [m] is the sum of the radii.
    In a right triangle, ``both`` and the tangent are the legs, and the line between the
    centres (``dx``, ``dy``) [m] is the hypotenuse.
    """
    square = dx * dx + dy * dy - both * both
    if not square >= -(ROUND_OFF * both) * both:
        return -1.0, 0.0, 0.0
    straight = sqrt(max(square, 0.0))
    return straight, arctangent2(dy, dx), arctangent2(both, straight)


@kernel
def left_right(circles: Circles) -> Solution:
    """The path LSR."""
    rl, rr, _, right, yaw, _ = circles
    straight, direction, opening = inner_tangent(right[0], right[1] - rl, rl + rr)
    if not straight >= 0.0:
        return inf, NONE, 0.0, 0.0, 0.0
    heading = direction + opening
    first = full_turn(heading)
    last = full_turn(heading - yaw)
    return straight + rl * first + rr * last, LSR, first, straight, last


@kernel
def right_left(circles: Circles) -> Solution:
    """The path RSL."""
    rl, rr, left, _, yaw, _ = circles
    straight, direction, opening = inner_tangent(left[0], left[1] + rr, rl + rr)
    if not straight >= 0.0:
        return inf, NONE, 0.0, 0.0, 0.0
    heading = direction - opening
    first = full_turn(-heading)
    last = full_turn(yaw - heading)
    return straight + rr * first + rl * last, RSL, first, straight, last


@kernel
def middle_opening(half: float) -> float:
    """Angle [rad] from the line of centres to the middle circle's centre. Negative if
    the middle circle cannot touch both others.

    ``half`` is half the distance of the centres, divided by rl + rr.
    """
    if not half <= 1.0 + ROUND_OFF:
        return -1.0
    return arccosine(min(half, 1.0))


@kernel
def right_arcs(circles: Circles, angle: float, side: float, opening: float) -> Solution:
    """The path RLR, with the middle circle's centre at ``side`` [rad] from the line of
    centres.
    """
    rl, rr, _, _, yaw, _ = circles
    if opening < 0.0:
        return inf, NONE, 0.0, 0.0, 0.0
    to_middle = angle + side
    back = angle + pi - side
    first = full_turn(0.5 * pi - to_middle)
    middle = full_turn(back - to_middle)
    last = full_turn(back - 0.5 * pi - yaw)
    return rr * (first + last) + rl * middle, RLR, first, middle, last


@kernel
def left_arcs(circles: Circles, angle: float, side: float, opening: float) -> Solution:
    """The path LRL, with the middle circle's centre at ``side`` [rad] from the line of
    centres.
    """
    rl, rr, _, _, yaw, _ = circles
    if opening < 0.0:
        return inf, NONE, 0.0, 0.0, 0.0
    to_middle = angle + side
    back = angle + pi - side
    first = full_turn(to_middle + 0.5 * pi)
    middle = full_turn(to_middle - back)
    last = full_turn(yaw - back - 0.5 * pi)
    return rl * (first + last) + rr * middle, LRL, first, middle, last


@kernel
def shortest_solution(circles: Circles) -> Solution:
    """Shortest path. Of several equally short ones, the first in the order of the
    words.
    """
    lsl, rsr, lsr, rsl, rlr_1, rlr_2, lrl_1, lrl_2 = dubins_solutions(circles)
    best = shorter(shorter(shorter(lsl, rsr), lsr), rsl)
    return shorter(shorter(shorter(shorter(best, rlr_1), rlr_2), lrl_1), lrl_2)


@kernel
def shorter(first: Solution, second: Solution) -> Solution:
    """The shorter of two paths, or the first if they are equally short."""
    return second if second[0] < first[0] * (1.0 - ROUND_OFF) else first


@kernel_wide
def shortest_dubins(
    start: Pose, goal: Pose, kappa_left: float, kappa_right: float
) -> tuple[float, int, Pose, Pose]:
    """Length [m], word, lengths [m] and curvatures [1/m] of the shortest path. NaN and
    ``NONE`` if a pose is not finite.
    """
    circles = turning_circles(start, goal, kappa_left, kappa_right)
    if not isfinite(circles[4]):
        return nan, NONE, (nan, nan, nan), (nan, nan, nan)
    length, word, first, middle, last = shortest_solution(circles)
    left = kappa_left
    right = -kappa_right
    initial = left if word in (LSL, LSR, LRL) else right
    end = left if word in (LSL, RSL, LRL) else right
    if word < RLR:
        lengths = (first / abs(initial), middle, last / abs(end))
        return length, word, lengths, (initial, 0.0, end)
    bend = left if word == RLR else right
    lengths = (first / abs(initial), middle / abs(bend), last / abs(end))
    return length, word, lengths, (initial, bend, end)


@kernel_wide
def shortest_dubins_length(
    start: Pose, goal: Pose, kappa_left: float, kappa_right: float
) -> tuple[float]:
    """Length [m] of the shortest path. NaN if a pose is not finite."""
    circles = turning_circles(start, goal, kappa_left, kappa_right)
    if not isfinite(circles[4]):
        return (nan,)
    return (shortest_solution(circles)[0],)
