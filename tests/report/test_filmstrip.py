"""The motions of a plan as a strip of pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

from pushpressslide.core.bodies import OBJECT, Stage
from pushpressslide.core.plan import Plan
from pushpressslide.report.filmstrip import filmstrip, motions
from pushpressslide.report.plan_files import write_plan_pictures
from pushpressslide.report.stages import StagePlan
from pushpressslide.selection.solve import plan
from pushpressslide.taskfile.load import load_task


@pytest.fixture(scope="module")
def carton() -> Plan:
    return plan(load_task("carton"))


def alone(made: Plan) -> StagePlan:
    return StagePlan(Stage(OBJECT, made.task.goal), made, ())


def test_each_motion_has_its_picture_with_its_mode_and_time(carton: Plan) -> None:
    every = motions(carton)
    assert len(every) == len(carton.task.legs) > 1
    titles = [ax.get_title("left") for ax in filmstrip(carton).axes]
    for i, (title, motion) in enumerate(zip(titles, every, strict=True)):
        seconds = sum(piece.profile.duration for piece in motion)
        assert title.startswith(f"{i + 1}. {motion[0].mode}")
        assert f"{seconds:.1f} s" in title


def test_all_pictures_show_the_same_part_of_the_table(carton: Plan) -> None:
    shown = {(ax.get_xlim(), ax.get_ylim()) for ax in filmstrip(carton).axes}
    assert len(shown) == 1


def test_only_a_plan_of_several_motions_has_a_strip(
    carton: Plan, tmp_path: Path
) -> None:
    write_plan_pictures([alone(carton)], tmp_path / "several")
    assert (tmp_path / "several" / "legs.png").stat().st_size > 10_000
    one = plan(load_task("rear-push-rear"))
    write_plan_pictures([alone(one)], tmp_path / "one")
    assert not (tmp_path / "one" / "legs.png").exists()
