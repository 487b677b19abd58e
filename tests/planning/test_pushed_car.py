"""Two arms behind an object, as a car (docs/mechanics.md, section 5)."""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.pose import Pose2
from pushpressslide.mechanics.face_push import Push, turnings
from pushpressslide.mechanics.faces import faces
from pushpressslide.planning.pushed_car import gentle_path, pushed_cars

TASK = load_task(
    "parallel-push",
    [
        "object.shape.box=[0.4, 0.4, 0.2]",
        "start.x=0.40",
        "start.y=0.08",
        "goal.x=0.86",
        "goal.y=0.10",
        "motion.contact_height=0.05",
    ],
)
REAR = next(face for face in faces(TASK.object, 0.01) if face.index == 3)
TOLD = replace(TASK, belief=replace(TASK.full_belief, rho=0.13))
HEIGHT = TASK.motion.contact_height
HALF = 0.09
D = 0.2
MU = TASK.scene.contact_friction
RUN_INS = (0.16, 0.08, 0.04)  # [m]


def test_on_the_ellipsoid_normal_forces_turn_it_with_w_over_rho_squared_about_the_cop() -> (
    None
):
    (car,) = pushed_cars(TOLD.scene, TOLD.motion, [(REAR, HALF)], synchronised=False)
    assert (car.left, car.right) == pytest.approx((HALF / 0.13**2, HALF / 0.13**2))
    assert car.effective_wheelbase == 0.0
    assert car.axle == pytest.approx(HEIGHT * 0.3)  # the CoP under way


def test_on_the_ellipsoid_equal_forces_make_it_a_rear_steer_car_with_mu_d_over_rho_squared() -> (
    None
):
    (car,) = pushed_cars(TOLD.scene, TOLD.motion, [(REAR, HALF)], synchronised=True)
    assert car.tightest == pytest.approx(MU * D / 0.13**2)
    assert car.effective_wheelbase == pytest.approx(0.13**2 / D)


@pytest.mark.parametrize("synchronised", [False, True])
def test_the_car_turns_like_the_exact_surface_where_it_is_used_and_no_tighter(
    synchronised: bool,
) -> None:
    (car,) = pushed_cars(TASK.scene, TASK.motion, [(REAR, HALF)], synchronised)
    use = TASK.motion.curvature_margin
    limit = (0.0, MU) if synchronised else (HALF, 0.0)
    pushes = [Push(REAR, share * limit[0], share * limit[1]) for share in (use, 1.0)]
    (axle, curvature), (_, tightest) = turnings(TASK.object, 0.3, HEIGHT, pushes)
    assert car.axle == pytest.approx(axle, abs=1e-4)
    model = use * (D * limit[1] + limit[0]) / car.rho**2
    assert model == pytest.approx(-curvature, rel=1e-6)
    assert car.tightest <= abs(tightest) + 1e-9


def test_the_path_ends_straight_where_there_is_room_and_is_the_shortest_where_there_is_none() -> (
    None
):
    roomy = gentle_path((Pose2(), Pose2(0.6, 0.05, 0.1)), 5.0, 0.7, RUN_INS)
    assert roomy.sections[-1] == pytest.approx((0.0, RUN_INS[0]))
    assert roomy.length <= 0.7
    back = gentle_path((Pose2(), Pose2(-0.3, 0.0, 0.0)), 5.0, 0.7, RUN_INS)
    assert back.length > 0.7 + math.pi / 5.0
