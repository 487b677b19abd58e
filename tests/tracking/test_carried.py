"""The holonomic law on a wall."""

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.tracking.carried import CarriedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker

SURFACE = DraggedSurface(26.0, 0.2, 0.0, (0.02, 0.05))
X_BV = Pose2(0.01, 0.0, 0.0)
PATH = TwistPath.between((Pose2(), Pose2(-0.2, 0.05, -0.6)), 0.3)
HERE = Pose2(-0.05, 0.0, -0.2)


def steps(weight, lever, here=HERE):
    carried = CarriedTracker(X_BV, SURFACE, weight, lever, 0.015)
    plain = HolonomicTracker(X_BV, SURFACE, decay=0.015)
    return (law.step(PATH, here, 0.0, 0.05, 1.0) for law in (carried, plain))


def test_without_a_weight_in_the_plane_it_is_the_holonomic_law() -> None:
    carried, plain = steps((0.0, 0.0), 0.0)
    assert carried == plain


def test_the_arms_give_what_slides_the_object_less_its_weight_at_the_centre_of_mass() -> (
    None
):
    carried, plain = steps((0.0, -19.62), 0.0)
    lifted = carried.wrench.moved_to((0.0, 0.0))
    slid = plain.wrench.moved_to((0.0, 0.0))
    up = HERE.unrotate((0.0, 19.62))
    assert (lifted.fx - slid.fx, lifted.fy - slid.fy) == pytest.approx(up)
    assert lifted.tau == pytest.approx(slid.tau)
    assert carried.twist == plain.twist
    assert carried.wrench.about == plain.wrench.about == SURFACE.center


def test_the_weight_moves_the_centre_of_pressure_up() -> None:
    lever = 0.001
    upright = Pose2(-0.05, 0.0, 0.0)
    carried, _ = steps((0.0, -19.62), lever, upright)
    moved = HolonomicTracker(
        X_BV, DraggedSurface(26.0, 0.2, 0.0, (0.02, 0.05 + lever * 19.62)), decay=0.015
    )
    slid = moved.step(PATH, upright, 0.0, 0.05, 1.0).wrench.moved_to((0.0, 0.0))
    assert carried.wrench.moved_to((0.0, 0.0)).tau == pytest.approx(slid.tau)
