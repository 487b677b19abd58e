"""Engines by name."""

import pytest

import pushpressslide
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.jobs.engines import DEFAULT, ENGINES, EngineName, engine_named
from pushpressslide.jobs.run import run, run_choice, run_task, simulate
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.taskfile.load import load_task


def test_every_name_of_the_command_line_has_its_engine() -> None:
    assert list(ENGINES) == list(EngineName)
    assert DEFAULT in ENGINES


def test_an_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(
        PushPressSlideError, match="'bullet' is not allowed; known: "
    ) as e:
        engine_named("bullet")
    assert all(name in str(e.value) for name in ENGINES)


ENTRIES = {
    "top": lambda task, folder: pushpressslide.run(task, engine="plana"),
    "run": lambda task, folder: run(task, engine="plana"),
    "simulate": lambda task, folder: simulate(task, engine="plana"),
    "run_task": lambda task, folder: run_task(task, engine="plana"),
    "run_choice": lambda task, folder: run_choice(task, None, engine="plana"),
    "sweep": lambda task, folder: sweep(
        task, SweepOptions(samples=1, engine="plana"), folder
    ),
}


@pytest.mark.parametrize("entry", ENTRIES.values(), ids=ENTRIES)
def test_every_entry_refuses_an_unknown_engine_before_anything_runs(
    entry, tmp_path
) -> None:
    with pytest.raises(
        PushPressSlideError, match=r"engine: 'plana' is not allowed; .*known: drake"
    ):
        entry(load_task("rear-push-rear"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_plan_is_refused_an_unknown_engine() -> None:
    plan = pushpressslide.plan(load_task("rear-push-rear"))
    with pytest.raises(PushPressSlideError, match="engine: 'plana' is not allowed"):
        run(plan, engine="plana")


def test_an_engine_without_arms_takes_every_plan_without_joint_paths() -> None:
    for engine in ENGINES.values():
        if engine.has_arms:
            continue
        preparation = engine.placement_planner(force=False)
        preparation.add("plan")
        assert list(preparation.plans) == ["plan"]
        assert not preparation.paths
