"""Two different arms in one cell, in Drake: shipped ones, and files as packages ship
them.
"""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps

DATA = "cmeel.prefix/share/example-robot-data/robots"
UR5E = ("airo-models 0.0.12", "airo_models/arms/ur5e/ur5e.urdf")
PANDA = ("example-robot-data 6.0.0", f"{DATA}/panda_description/urdf/panda.urdf")
BASES = {
    "bimanual-slide": ("{y: 0.4, z: 0.2}", "{y: -0.4, z: 0.2}"),
    "hand-over": ("{y: 0.4, z: 0.2}", "{y: -0.4, z: 0.2}"),
    "parallel-push": (
        "{y: 0.5, z: 0.2, yaw_deg: 24.6}",
        "{y: -0.5, z: 0.2, yaw_deg: 24.1}",
    ),
}


def run_with(task: str, models: tuple[str, str]) -> pps.Record:
    """A shipped task of two arms, with other arms on its bases."""
    arms = (
        f"{{{model}, base: {base}}}"
        for model, base in zip(models, BASES[task], strict=True)
    )
    loaded = pps.load_task(task, [f"robots=[{', '.join(arms)}]"])
    record = pps.run(loaded, engine="drake")
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 2e-3
    assert record.figures["final_yaw_error"] < math.radians(1.0)
    return record


@pytest.mark.parametrize(
    "task",
    [
        "bimanual-slide",
        pytest.param("hand-over", marks=pytest.mark.long),
        pytest.param("parallel-push", marks=pytest.mark.long),
    ],
)
def test_a_ur5e_and_a_panda_work_together(task: str) -> None:
    record = run_with(task, ("model: ur5e", "model: panda"))
    used = {c.arm for segment in record.plan.segments for c in segment.contacts}
    assert used == {0, 1}


@pytest.mark.long
@pytest.mark.parametrize("task", ["bimanual-slide", "hand-over"])
def test_so_do_their_files(public_file, task: str) -> None:
    left = f"model: {public_file(*UR5E)}, tip: {{link: tool0}}"
    right = f"model: {public_file(*PANDA)}, tip: {{link: panda_link8}}"
    record = run_with(task, (left, right))
    used = {c.arm for segment in record.plan.segments for c in segment.contacts}
    assert used == {0, 1}
