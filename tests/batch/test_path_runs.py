"""A tip, a path and a tick on arrays, like one of them by the single form."""

import math

import numpy as np
import pytest

from pushpressslide.batch.compliant_push import PushingTip, tip_pushed
from pushpressslide.batch.elementwise import run
from pushpressslide.batch.path_pieces import Piece, beside, eased, pieces_of
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.planar.contact import TipLaw, side_contact
from pushpressslide.planar.sliding import slide
from pushpressslide.planar.support_friction import SupportFriction

ROWS = 400
DAMPING = 500.0  # [N s/m]
RADIUS = 0.02  # [m]
PATH = ArcPath(
    Pose2(0.4, 0.2, 0.3), ((-9.0, 0.21), (0.0, 0.09), (7.0, 0.9), (0.0, 0.16))
)


def pushes() -> PushingTip:
    """Return tips that stick, slip, only touch, or are led away; n is x of B."""
    rng = np.random.default_rng(0)
    fn = rng.uniform(-2.0, 30.0, ROWS)
    pn = -rng.uniform(0.03, 0.1, ROWS)
    return PushingTip(
        fn,
        rng.uniform(-1.0, 1.0, ROWS) * np.abs(fn),
        pn,
        rng.uniform(-0.05, 0.05, ROWS),
        pn - RADIUS,
        rng.uniform(0.1, 1.0, ROWS),
        rng.uniform(1.0, 6.0, ROWS),
        rng.uniform(0.03, 0.1, ROWS) ** 2,
    )


def formula(tip: PushingTip):
    return tuple(tip_pushed(tip))


def test_a_compliant_tip_pushes_as_on_the_planar_engine(engine):
    tips = pushes()
    out = np.empty((5, ROWS))
    run(formula, (tips,), (out,))
    statuses = set()
    for i in range(ROWS):
        fn, ft, pn, pt, cn, mu, drag, square = (float(c[i]) for c in tips)
        law = TipLaw((1.0, 0.0), (fn, ft), (DAMPING, DAMPING))
        contact = side_contact((cn, pt), RADIUS, 0.0, law, mu, 0.004)
        assert contact.point == pytest.approx((pn, pt))
        pin = PressureSamples(
            np.zeros((1, 2)), np.ones(1), np.full(1, math.sqrt(square))
        )
        twist = slide(SupportFriction(pin), drag, [contact], (0.0, 0.0, 0.0))
        answer = contact.response(twist)
        statuses.add(answer.status)
        assert out[:2, i] == pytest.approx(answer.force, abs=2e-4)
        rate = out[2, i] / DAMPING
        moment = pn * out[1, i] - pt * out[0, i]
        found = rate * np.array((out[0, i], out[1, i], moment / square))
        assert found == pytest.approx(twist, abs=2e-5)
    assert statuses == {"free", "stick", "slip_left", "slip_right"}


def places(at: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points beside the path, on its piece at arc length ``at`` [m]."""
    rng = np.random.default_rng(1)
    index = PATH._piece(at)
    start = PATH.starts[index][0]
    end = PATH.starts[index + 1][0]
    s = rng.uniform(start + 1e-3, end - 1e-3, ROWS)
    left = rng.uniform(-0.03, 0.03, ROWS)
    poses = [PATH.pose(one) for one in s]
    x = np.array([p.x - a * math.sin(p.yaw) for p, a in zip(poses, left, strict=True)])
    y = np.array([p.y + a * math.cos(p.yaw) for p, a in zip(poses, left, strict=True)])
    return s, x, y


@pytest.mark.parametrize("number", range(4))
def test_the_nearest_point_of_a_piece_is_that_of_the_path(number):
    at = PATH.starts[number][0] + 1e-3
    s, x, y = places(at)
    piece = Piece(*(np.full(ROWS, v) for v in pieces_of(PATH)[:, number]))
    found = beside(x, y, s, piece)
    smooth = eased(found, np.float64(0.012), piece)
    for i in range(ROWS):
        wanted = PATH.nearest(float(x[i]), float(y[i]), float(s[i]))
        assert [float(np.broadcast_to(c, ROWS)[i]) for c in found] == pytest.approx(
            wanted, abs=1e-9
        )
        turned, bent = PATH.eased(wanted[0], 0.012)
        assert smooth.yaw[i] - wanted[2] == pytest.approx(turned, abs=1e-9)
        assert smooth.curvature[i] - wanted[3] == pytest.approx(bent, abs=1e-9)


def test_the_line_after_the_path_goes_on_straight():
    piece = Piece(*pieces_of(PATH)[:, -1])
    end = PATH.pose(PATH.length + 0.05)
    found = eased(beside(end.x, end.y, PATH.length, piece), np.float64(0.01), piece)
    assert found.progress == pytest.approx(PATH.length + 0.05)
    assert found.left == pytest.approx(0.0, abs=1e-12)
    assert found.curvature == 0.0
