"""``pps run --anyway``: what is refused runs if it has a path, and else it is said."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app

CRATE = """\
name: crate
object: {shape: {box: [0.4, 0.4, 0.3]}, mass: 12.0}
support: {friction: 0.4}
start: {x: 0.5, y: 0.25}
goal: {x: 0.62, y: 0.0}
limits: {normal_force: 20}
robots: [{model: iiwa7, base: {x: 0, y: 0.4}}, {model: iiwa7, base: {y: -0.6}}]
"""


def run(tmp_path: Path, *words: str) -> Any:
    file = tmp_path / "crate.yaml"
    file.write_text(CRATE)
    out = ("--out", str(tmp_path / "out"), "--engine", "planar", "--anyway")
    return CliRunner().invoke(app, ["run", str(file), *words, *out])


@pytest.mark.parametrize("mode", ["orthogonal_push", "parallel_push"])
def test_a_push_beyond_the_force_limit_runs(mode: str, tmp_path: Path) -> None:
    result = run(tmp_path, "--mode", mode)
    assert result.exit_code in (0, 1), result.stderr
    figures = json.loads((tmp_path / "out" / "result.json").read_text())
    assert figures["modes"] == [mode]
    assert "although it is refused" in " ".join(result.stdout.split())
    assert "N, allowed 18 N by limits" in " ".join(result.stdout.split())


def test_what_has_no_path_at_all_says_so(tmp_path: Path) -> None:
    high = ("--set", "motion.contact_height=0.29", "--set", "support.friction=1.5")
    result = run(tmp_path, "--mode", "orthogonal_push", *high)
    assert result.exit_code == 2
    line = " ".join(result.stderr.split())
    assert "none has a path that could be run anyway; orthogonal_push: touched" in line
