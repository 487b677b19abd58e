"""An object that two arms push on one face, as a car: fitted to the exact limit
surface, and its paths.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.mechanics.face_push import Push, on_face, turnings
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.run_in import with_run_in
from pushpressslide.rom.differential_car import DifferentialCar
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import RearSteerCar

ORIGIN = (0.0, 0.0)
RUN_INS = (0.16, 0.08, 0.04)  # [m] straight ends that are tried
# curvatures that are tried, in shares of the tightest that a plan may use
TIGHTER = (0.3, 0.6, 1.0)


def pushed_cars(
    task: Task, places: Sequence[tuple[Face, float]], height: float, synchronised: bool
) -> list[PushedCar]:
    """Return the reduced model, as believed, of contacts on each face, as far [m]
    either side of the CoM's line.

    Turned by normal forces alone it is a differential car, ``synchronised``, by equal
    forces, a rear-steer one (docs/mechanics.md, section 5). Axle and rho are those of
    the exact surface, under the load that the push at ``height`` [m] itself shifts, at
    ``curvature_margin`` of the force's way to its limits; the tightest curves are no
    tighter than the object's. Raises ValueError where the object tips.
    """
    belief = task.believed
    use = task.motion.curvature_margin
    mu_s = belief.support_friction
    mu_a = belief.contact_friction
    pushes = []
    for face, half_width in places:
        for share in (-use, use, -1.0, 1.0):
            off = (0.0, share * mu_a) if synchronised else (share * half_width, 0.0)
            pushes.append(Push(face, *off))
    turned = turnings(task.object, mu_s, height, pushes) if belief.rho is None else []
    out = []
    for i, (face, half_width) in enumerate(places):
        # how far off the CoM the force may be, or how much across the normal; and the
        # moment that this makes
        limit, arm = (mu_a, face.depth) if synchronised else (half_width, 1.0)
        if belief.rho is not None:
            rho = belief.rho
            shift = height * mu_s
            least = (math.inf, math.inf)
        else:
            right, left, rightmost, leftmost = turned[4 * i : 4 * i + 4]
            mean = 0.5 * (1.0 / abs(right.curvature) + 1.0 / abs(left.curvature))
            rho = math.sqrt(arm * use * limit * mean)
            shift = 0.5 * (right.axle + left.axle) - (
                rho * rho / face.depth if synchronised else 0.0
            )
            least = abs(rightmost.curvature), abs(leftmost.curvature)
        heading = math.atan2(face.normal[1], face.normal[0])
        lead = rho * rho / face.depth if synchronised else 0.0
        car = (
            RearSteerCar(on_face(face, 0.0), face.normal, ORIGIN, rho, mu_a)
            if synchronised
            else DifferentialCar(ORIGIN, heading, half_width, half_width, rho)
        )
        low, high = car.curvature_limits
        out.append(
            PushedCar(
                heading,
                shift + lead,
                lead,
                rho,
                min(high, least[0]),
                min(-low, least[1]),
            )
        )
    return out


def gentle_path(start: Pose2, goal: Pose2, tightest: float, longest: float) -> ArcPath:
    """Return the path of up to ``longest`` [m] with the longest run-in, then the
    gentlest turns, none above ``tightest`` [1/m]; the shortest one where there is none.
    """
    tried = []
    for run_in in RUN_INS:
        for share in TIGHTER:
            curvature = share * tightest
            path = with_run_in(start, goal, curvature, curvature, run_in)
            if path.length <= longest:
                return path
            tried.append(path)
    return min(tried, key=lambda path: path.length)
