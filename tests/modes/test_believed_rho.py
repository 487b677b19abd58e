"""A believed rho decides what every mode plans."""

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Choice
from pushpressslide.core.task import Belief, Robot, Task
from pushpressslide.planning.pressed.turns import turn_table
from pushpressslide.planning.pressed.vehicle import press_of, steered

NAMES = (
    "rear-push-rear",
    "press-slide",
    "press-slide-car",
    "press-slide-pivot",
    "parallel-push",
    "orthogonal-push",
    "bimanual-slide",
)
SMALL = 0.08  # [m]
LARGE = 0.16


def believing(name: str, rho: float | None) -> Task:
    task = pps.load_task(name)
    hands = tuple(Robot("hand", robot.base) for robot in task.robots)
    return replace(task, robots=hands, belief=Belief(rho=rho))


def drives(choices: list[Choice]):
    return [
        (piece.drive, piece.path) for choice in choices for piece in choice.segments
    ]


@pytest.mark.parametrize("name", NAMES)
def test_plans_for_two_values_of_rho_differ(name: str) -> None:
    small = pps.select(believing(name, SMALL))
    large = pps.select(believing(name, LARGE))
    assert drives(small) or small[0].refusal is not None
    reasons = [[choice.reason for choice in choices] for choices in (small, large)]
    assert drives(small) != drives(large) or reasons[0] != reasons[1]


def test_nothing_is_planned_with_the_rho_of_the_shape_in_its_place() -> None:
    for rho in (SMALL, LARGE, 0.5):
        for choice in pps.select(believing("press-slide", rho)):
            for piece in choice.segments:
                car = piece.drive.car
                wheelbase = abs(car.effective_wheelbase * car.lever)
                if choice.label.startswith("pulled"):
                    assert math.sqrt(wheelbase) == pytest.approx(rho, rel=0.15)


def test_a_rho_with_which_nothing_is_possible_is_refused() -> None:
    choices = pps.select(believing("press-slide", 0.25))
    assert not any(choice.feasible for choice in choices)
    assert all(choice.reason.endswith("with belief.rho 0.25 m") for choice in choices)


@pytest.mark.parametrize("rho", [SMALL, LARGE])
def test_a_press_on_the_ellipsoid_has_its_axle_at_rho_squared_over_the_lever(
    rho: float,
) -> None:
    task = believing("press-slide", rho)
    (contact,) = pps.plan(pps.load_task("press-slide")).contacts
    press = press_of(task.scene, contact)
    flat = replace(press, friction=1e-9)  # no drag that moves the centre of pressure
    for angle in (0.0, 0.3, 0.6):
        car = steered(flat, False, angle)
        assert car.rho == pytest.approx(rho)
        assert car.shift == pytest.approx(0.0, abs=1e-6)
    table = turn_table((flat,), task.motion.speed)
    straight = table.effective_wheelbase[0, 0]
    assert straight == pytest.approx(rho * rho / press.lever, rel=0.01)
    px, py = flat.pivot(True)
    behind = math.dist((px, py), press.cop)
    assert behind == pytest.approx(rho * rho / press.lever, rel=1e-6)
