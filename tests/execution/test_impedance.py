"""The moment that holds a tool's attitude."""

import math

import numpy as np
import pytest

from pushpressslide.core import margins
from pushpressslide.execution.impedance import tip_moment

STIFFNESS = 30.0
DAMPING = 2.0
REST = np.zeros(3)


def turned(angle: float) -> np.ndarray:
    """Return the rotation by ``angle`` [rad] about z."""
    c = math.cos(angle)
    s = math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def moment(angle: float, spin: float = 0.0) -> float:
    """Return the moment about z of a tool off by ``angle`` [rad], at ``spin`` [rad/s]."""
    w = np.array([0.0, 0.0, spin])
    got = tip_moment(turned(angle), np.eye(3), REST, w, STIFFNESS, DAMPING)
    assert got[:2] == pytest.approx([0.0, 0.0])
    return float(got[2])


@pytest.mark.parametrize("angle", [-0.15, 0.05, 0.19])
def test_a_tool_a_little_off_is_turned_by_a_spring(angle: float) -> None:
    assert moment(angle) == pytest.approx(STIFFNESS * math.sin(angle))


@pytest.mark.parametrize("angle", [0.3, 1.2, 2.5])
def test_a_tool_far_off_is_turned_no_harder(angle: float) -> None:
    assert moment(angle) == pytest.approx(STIFFNESS * margins.ARM.attitude)
    assert moment(-angle) == pytest.approx(-STIFFNESS * margins.ARM.attitude)


def test_a_tool_that_spins_is_braked_however_far_off_it_is() -> None:
    assert moment(2.0, spin=5.0) == pytest.approx(
        STIFFNESS * margins.ARM.attitude - 5.0 * DAMPING
    )
