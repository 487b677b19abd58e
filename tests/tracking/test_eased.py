"""The pull towards the path is eased until the contacts hold."""

import math

import pytest

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.tracking.eased import EasedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker

PATH = TwistPath.between((Pose2(), Pose2(0.3, 0.0, 0.0)), 0.15)
OFF = Pose2(0.1, 0.02, 0.0)  # to the left of the path
LAW = HolonomicTracker(Pose2(), DraggedSurface(6.0, 0.1), decay=0.015)


def asked(steepest: float) -> tuple[float, bool]:
    """The angle of the force that is asked for where contacts hold up to ``steepest``
    [rad]; and whether the law was left alone.
    """

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        margin = steepest - abs(math.atan2(fy, fx))
        return Allocation(((fx, fy),), (0.0,), margin, "ok")

    eased = EasedTracker(LAW, allocate).step(PATH, OFF, 0.1, 0.05, 1.0)
    return math.atan2(eased.wrench.fy, eased.wrench.fx), eased == LAW.step(
        PATH, OFF, 0.1, 0.05, 1.0
    )


def test_what_the_contacts_hold_is_asked_for_as_the_law_has_it() -> None:
    angle, same = asked(1.0)
    assert same
    assert angle < -0.3


@pytest.mark.parametrize("steepest", [0.3, 0.2, 0.1])
def test_a_pull_that_they_do_not_hold_is_eased_but_goes_on(steepest: float) -> None:
    angle, same = asked(steepest)
    assert not same
    assert -steepest <= angle < 0.0


def test_where_nothing_holds_the_paths_own_motion_is_asked_for() -> None:
    angle, _ = asked(-1.0)
    assert angle == pytest.approx(0.0, abs=1e-12)
