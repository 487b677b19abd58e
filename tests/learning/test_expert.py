"""The controller of a mode as a policy, in its own environment; no Gymnasium needed."""

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.batch.pushing import SideContact
from pushpressslide.core.errors import TaskError
from pushpressslide.learning.demonstrations import demonstrate
from pushpressslide.learning.push_task import push_task
from pushpressslide.learning.registration import TASKS
from pushpressslide.planning.rear_car_fit import ANGLES, fitted_faces, push_twists


@pytest.mark.parametrize("task", TASKS.values())
def test_the_expert_succeeds_in_95_of_100(task) -> None:
    push = push_task(task)
    shown = demonstrate(push, range(100))
    assert shown.success.mean() >= 0.95
    assert np.abs(shown.actions).max() < push.speed_limit


@pytest.mark.parametrize("task", TASKS.values())
def test_the_expert_succeeds_on_the_exact_limit_surface(task) -> None:
    shown = demonstrate(push_task(task), range(5), exact=True)
    assert shown.success.all()


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS.values())
def test_the_expert_succeeds_in_95_of_100_on_the_exact_limit_surface(task) -> None:
    shown = demonstrate(push_task(task), range(100), exact=True)
    assert shown.success.mean() >= 0.95


@pytest.mark.parametrize(
    ("task", "sets"),
    [
        ("rear-push-rear", ["belief.contact_friction=0.5"]),
        ("rear-push-rear", ["belief.center_of_mass=[0.0, 0.004]"]),
        ("sugar-box", []),
        ("l-shape", ["goal={x: 0.65, y: 0.25, yaw_deg: 30}"]),
    ],
)
def test_the_expert_of_other_tasks_and_of_wrong_beliefs(task, sets) -> None:
    shown = demonstrate(push_task(pps.load_task(task, sets)), range(20))
    assert shown.success.mean() >= 0.9


def test_what_is_believed_changes_no_truth() -> None:
    told = pps.load_task("rear-push-rear", ["belief.support_friction=0.5"])
    mine, true = push_task(told), push_task("rear-push-rear")
    assert (mine.rho, mine.center, mine.foot) == (true.rho, true.center, true.foot)


def test_the_friction_of_the_support_moves_the_center_of_pressure() -> None:
    push = push_task("rear-push-rear")
    rougher = push_task(pps.load_task("rear-push-rear", ["support.friction=0.4"]))
    assert rougher.center[0] == pytest.approx(push.center[0] * 4.0 / 3.0)


@pytest.mark.parametrize(
    ("task", "said"),
    [
        ("press-slide", "modes: "),
        ("incline-slide", "support.kind: "),
        ("post", "obstacles: 1 of them is not allowed; allowed to learn: none"),
        ("tour", "is not allowed; allowed to learn: none"),
        (
            pps.load_task("rear-push-rear", ["truth=tier2"]),
            "truth: given is not allowed; allowed to learn: its defaults",
        ),
    ],
)
def test_a_task_of_another_kind_is_refused(task, said) -> None:
    with pytest.raises(TaskError) as refused:
        push_task(task)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_round_face_is_refused() -> None:
    task = pps.load_task("rear-push-rear", ["motion.face=null"])
    cylinder = pps.Cylinder(0.08, 0.1)
    round_one = replace(task, object=replace(task.object, shape=cylinder))
    with pytest.raises(TaskError, match="round"):
        push_task(round_one)


@pytest.mark.parametrize("task", TASKS.values())
def test_an_object_turns_as_on_the_exact_limit_surface(task) -> None:
    """For the same velocity of the tip; within 4 % up to the planned share of the cone,
    within 8 % at its edge.
    """
    push = push_task(task)
    scene = push.task.scene
    motion = push.task.motion
    (fitted,) = fitted_faces(scene, motion)
    (exact,) = push_twists(scene, motion, [fitted.face])
    x, y = fitted.face.foot
    tip = exact[..., :2] + exact[..., 2:] * np.array([-y, x])
    contact = SideContact(push.foot, push.normal, push.task.contact_friction, push.rho)
    turns = contact.push(tip).twist[..., 2] / exact[..., 2]
    planned, _ = ANGLES
    assert np.abs(turns[:, :planned] - 1.0).max() < 0.045
    assert np.abs(turns - 1.0).max() < 0.08
