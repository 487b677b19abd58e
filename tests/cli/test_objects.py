"""``pps object``: base, side and top of an object, from its mesh or its task."""

import json
from pathlib import Path

import pytest
import trimesh
from typer.testing import CliRunner

from pushpressslide.cli import app

RUNNER = CliRunner()


def shown(*words: str, folder: Path) -> str:
    result = RUNNER.invoke(app, ["object", *words, "--out", str(folder)])
    assert result.exit_code == 0, result.output
    return result.output


def test_a_mesh_is_shown_with_a_picture(tmp_path: Path) -> None:
    file = tmp_path / "cone.stl"
    trimesh.creation.cone(0.05, 0.08).export(file)
    output = shown(str(file), folder=tmp_path)
    assert "base:   100 x 100 mm" in output
    assert "push:   no: its sides lean by 32 deg" in output
    assert "press:  no" in output
    assert (tmp_path / "object-cone" / "object.png").stat().st_size > 10_000


def test_plain_data_have_the_figures(tmp_path: Path) -> None:
    file = tmp_path / "box.stl"
    trimesh.creation.box((0.1, 0.06, 0.05)).export(file)
    words = (str(file), "--json", "--radius", "0.0125")
    data = json.loads(shown(*words, folder=tmp_path))
    assert data["base"] == "whole"
    assert data["push"] is True
    assert data["press_height"] == pytest.approx(0.05)
    assert data["standing"] == pytest.approx(0.03)


def test_a_task_brings_its_own_object(tmp_path: Path) -> None:
    assert "push:   at" in shown("rear-push-rear", folder=tmp_path)


def test_a_file_of_no_object_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "nothing.stl"
    file.write_text("solid nothing\nendsolid nothing\n")
    result = RUNNER.invoke(app, ["object", str(file), "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert "object.shape.mesh.path" in result.output
