"""What an arm can do over a table, and the command that says it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.core.scene import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.sheet import (
    gravity_torque,
    largest_force,
    potential_energy,
    workspace,
)
from pushpressslide.robots.urdf import urdf_text

KIN = arm_kinematics(Robot("panda"))


def test_the_weight_of_a_panda_hangs_on_its_shoulder() -> None:
    stretched = np.array([[0.0, 1.0, 0.0, -0.5, 0.0, 1.0, 0.0]])
    tau = gravity_torque(KIN, stretched)[0]
    assert abs(tau[0]) < 1e-6  # about the vertical
    assert abs(tau[1]) > 30.0
    raised = potential_energy(KIN, np.zeros(7)) > potential_energy(KIN, KIN.facts.home)
    assert raised


def test_the_largest_force_brings_a_joint_to_its_limit_and_none_beyond() -> None:
    q = KIN.facts.home[None]
    down = np.array([0.0, 0.0, -1.0])
    force = largest_force(KIN, q, down)
    # the tip presses down, so the table presses up
    tau = gravity_torque(KIN, q) + force[:, None] * (
        KIN.jacobian(q)[:, 3:].transpose(0, 2, 1) @ down
    )
    share = np.abs(tau[0]) / KIN.facts.effort_limit
    assert share.max() == pytest.approx(1.0, abs=1e-9)


def test_the_workspace_is_a_ring_about_the_base() -> None:
    space = workspace(KIN)
    far = np.hypot(*space.points[:, :2].T)
    assert 0.6 < far[space.reached].max() < 0.86
    assert not space.reached[far > 0.9].any()
    assert np.isnan(space.press[~space.reached]).all()
    assert (space.push[space.reached] > 0.0).all()


def test_the_command_says_it_and_draws_it(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["robot", "panda", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "panda: 7 joints, 17.99 kg" in result.output
    assert "robots: [{model: panda}]" in result.output
    assert (tmp_path / "robot-panda" / "robot.png").stat().st_size > 10_000
    result = CliRunner().invoke(
        app, ["robot", "panda", "--json", "--out", str(tmp_path)]
    )
    data = json.loads(result.stdout)
    assert data["missing"] == {}
    assert data["press"][0] > 50.0


def test_the_line_for_the_task_holds_what_the_command_was_given(tmp_path: Path) -> None:
    given = ["robot", "panda", "--length", "0.1", "--out", str(tmp_path), "--json"]
    data = json.loads(CliRunner().invoke(app, given).stdout)
    assert data["robots"] == "robots: [{model: panda, tip_length: 0.1}]"
    facts = KIN.facts
    path = tmp_path / "panda.urdf"
    text = urdf_text(facts).replace('velocity="2.175"', "", 1)
    path.write_text(text)
    given = ["robot", str(path), "--radius", "0.01", "--out", str(tmp_path), "--json"]
    data = json.loads(CliRunner().invoke(app, given).stdout)
    tip = "tip: {link: panda_link8, radius: 0.01}"
    limits = "limits: [{joint: panda_joint1, speed_deg_s: ...}]"
    assert data["robots"] == f"robots: [{{model: {path}, {tip}, {limits}}}]"


def test_a_file_that_is_not_there_is_refused_in_one_line(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["robot", str(tmp_path / "no.urdf")])
    assert result.exit_code == 2
    assert "no such file" in result.output
