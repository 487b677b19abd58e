"""What an arm's driver takes, and how late it follows, in a task file."""

from typing import Any

import pytest
import yaml

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.core.errors import TaskError
from pushpressslide.core.task import Robot
from pushpressslide.taskfile.load import dump_task, task_from_data

SERVO = {"interface": "velocity", "rate": 125, "lag": 0.02, "delay": 0.008}


def with_robot(fields: dict[str, Any]) -> dict[str, Any]:
    data: dict[str, Any] = yaml.safe_load(dump_task(pps.load_task("rear-push-rear")))
    data["robots"][0].update(fields)
    return data


def test_the_fields_are_read() -> None:
    robot = task_from_data(with_robot(SERVO), "test").robots[0]
    assert (robot.interface, robot.rate) == ("velocity", 125.0)
    assert (robot.lag, robot.delay) == (0.02, 0.008)
    assert robot.reaction == pytest.approx(0.036)


def test_they_are_written_and_read_again() -> None:
    task = task_from_data(with_robot(SERVO), "test")
    text = dump_task(task)
    assert yaml.safe_load(text)["robots"][0].items() >= SERVO.items()
    assert task_from_data(yaml.safe_load(text), "test").robots == task.robots


def test_an_arm_takes_torques_unless_it_is_said() -> None:
    robot = Robot("panda")
    assert (robot.interface, robot.rate, robot.lag, robot.delay) == (
        "torque",
        250.0,
        0.0,
        0.0,
    )


@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("interface", "positions", "one of torque, velocity, position"),
        ("rate", 0, "[20, 2000]"),
        ("rate", 2001, "[20, 2000]"),
        ("lag", -0.01, "[0, 0.5]"),
        ("lag", 0.6, "[0, 0.5]"),
        ("delay", "long", "a finite number [s] in [0, 0.5]"),
    ],
)
def test_a_wrong_value_is_refused_with_what_is_allowed(
    field: str, value: object, allowed: str
) -> None:
    with pytest.raises(TaskError) as caught:
        task_from_data(with_robot({field: value}), "test")
    message = str(caught.value)
    assert f"robots[0].{field}" in message
    assert allowed in message
    assert "\n" not in message


def test_torques_are_late_by_a_few_ticks_at_most() -> None:
    latest = margins.LATEST_TORQUE
    (robot,) = task_from_data(with_robot({"delay": latest}), "test").robots
    assert robot.delay == latest
    with pytest.raises(TaskError, match=r"robots\[0\]\.delay: 0\.02 .*0\.016"):
        task_from_data(with_robot({"delay": 0.02}), "test")


def test_an_arm_without_torques_has_no_errors_of_them() -> None:
    truth = {"arm_base_yaw_deg": 0.5, "encoder_bias_deg": 0.1, "torque_scale": 0.1}
    data = with_robot(SERVO) | {"truth": truth}
    with pytest.raises(TaskError) as caught:
        task_from_data(data, "test")
    assert str(caught.value) == (
        "test: truth.torque_scale: 0.1 is not allowed; "
        "allowed with robots[0].interface velocity: 0.0"
    )
    whole = task_from_data(with_robot({}) | {"truth": truth}, "test").truth
    data["truth"].pop("torque_scale")
    assert task_from_data(data, "test").truth == whole.for_servos()
    assert whole.encoder_bias == pytest.approx(0.1 * 0.0174533, rel=1e-5)
