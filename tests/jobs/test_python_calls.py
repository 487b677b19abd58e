"""Calls of a first hour in Python: what works, and mistakes, each with its one line."""
# ruff: noqa: E501

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps

NAME = "rear-push-rear"
TASK = pps.load_task(NAME)
START = {"x": 0.45, "y": 0.1}
MINE = {
    "name": "mine",
    "object": {"shape": {"box": [0.1, 0.1, 0.1]}, "mass": 0.5},
    "start": START,
    "goal": {"x": 0.55, "y": -0.1},
    "robots": [{"model": "panda"}],
}


def changed(**changes: Any) -> pps.Task:
    """The shipped task with other fields, checked."""
    return pps.check_task(replace(TASK, **changes))


def heavy(**changes: Any) -> pps.Task:
    return changed(object=replace(TASK.object, **changes))


def moved(**changes: Any) -> pps.Task:
    return changed(motion=replace(TASK.motion, **changes))


def run(task: Any = TASK, **options: Any) -> pps.Record:
    return pps.run(task, **{"engine": "planar", **options})


CUBE = pps.Box((0.1, 0.1, 0.1))
GOAL = pps.Pose2(0.6, -0.1, 0.2)
WORKS: dict[str, tuple[Callable[[], Any], Any]] = {
    "box from a list": (lambda: heavy(shape=pps.Box([0.1, 0.1, 0.1])).object.shape.size, (0.1,) * 3),
    "box from an array": (lambda: heavy(shape=pps.Box(np.full(3, 0.1))).object.shape.size, (0.1,) * 3),
    "shape from a list": (lambda: heavy(shape=[0.1, 0.1, 0.1]).object.shape, CUBE),
    "shape from a mapping": (lambda: heavy(shape={"box": (0.1, 0.1, 0.1)}).object.shape, CUBE),
    "object with such a shape": (lambda: changed(object=pps.Object([0.1, 0.1, 0.1], 0.5)).object, pps.Object(CUBE, 0.5)),
    "pose from a tuple": (lambda: changed(goal=(0.6, -0.1, 0.2)).goal, GOAL),
    "pose without a yaw": (lambda: changed(goal=[0.6, -0.1]).goal, pps.Pose2(0.6, -0.1)),
    "pose from an array": (lambda: changed(goal=np.array([0.6, -0.1, 0.2])).goal, GOAL),
    "pose of NumPy's numbers": (lambda: changed(goal=pps.Pose2(*np.array([0.6, -0.1, 0.2]))).goal, GOAL),
    "pose from a mapping": (lambda: changed(goal={"x": 0.6, "y": -0.1, "yaw": 0.2}).goal, GOAL),
    "pose from a mapping in degrees": (lambda: changed(goal={"x": 0.6, "y": -0.1, "yaw_deg": 10}).goal.yaw, math.radians(10)),
    "pose in degrees": (lambda: pps.Pose2.deg(0.6, -0.1, -20).yaw, math.radians(-20)),
    "robots by name": (lambda: changed(robots=("panda",)).robots, (pps.Robot("panda"),)),
    "one robot alone": (lambda: changed(robots=pps.Robot("panda")).robots, (pps.Robot("panda"),)),
    "base from a list": (lambda: changed(robots=[pps.Robot("panda", base=[0, 0.1, 0])]).robots[0].base, (0.0, 0.1, 0.0)),
    "one mode alone": (lambda: changed(modes="rear_push").modes, ("rear_push",)),
    "limits from a mapping": (lambda: changed(limits={"time": 60}).limits, pps.Limits(time=60.0)),
    "task from a mapping": (lambda: pps.load_task(MINE).start, pps.Pose2(0.45, 0.1)),
    "task from a mapping with parts": (lambda: pps.load_task({**MINE, "goal": GOAL, "robots": "panda"}).goal, GOAL),
    "overrides as a mapping": (lambda: pps.load_task(NAME, {"contact.friction": 0.5}).contact_friction, 0.5),
    "override of a pose": (lambda: pps.load_task(NAME, {"goal": (0.6, -0.1, 0.2)}).goal, GOAL),
    "override of a robot": (lambda: pps.load_task(NAME, {"robots.0.model": "iiwa7"}).robots[0].model, "iiwa7"),
    "override as a text": (lambda: pps.load_task(NAME, "limits.time=60").limits.time, 60.0),
    "task by a path object": (lambda: pps.load_task(Path(NAME)).name, NAME),
    "select by name": (lambda: pps.select(NAME)[0].mode, "rear_push"),
    "plan with a mode's name": (lambda: pps.plan(NAME, "rear_push").segments[0].mode, "rear_push"),
    "run by name": (lambda: run(NAME, mode="rear_push", overrides={"contact.friction": 0.5}).success, True),
    "goal is the start": (lambda: run(replace(TASK, goal=TASK.start)).success, True),
    "a task that is right": (lambda: pps.check_task(TASK) is TASK, True),
}  # fmt: skip


@pytest.mark.parametrize("name", WORKS)
def test_it_works(name: str) -> None:
    call, wanted = WORKS[name]
    assert call() == wanted


NAN = math.nan
MISTAKES: dict[str, tuple[Callable[[], Any], str]] = {
    "override of a wrong field": (lambda: pps.load_task(NAME, {"contact.fricton": 0.5}), "contact.fricton did you mean 'friction'"),
    "override out of range": (lambda: pps.load_task(NAME, {"contact.friction": 5}), "contact.friction: 5 is (0, 2)"),
    "override without a value": (lambda: pps.load_task(NAME, ["contact.friction"]), "field.field=value"),
    "override of a number alone": (lambda: pps.load_task(NAME, 3), "override 3"),
    "override of no index": (lambda: pps.load_task(NAME, {"robots.7.model": "panda"}), "robots.7 index from 0 to 0"),
    "degrees for radians": (lambda: changed(goal=pps.Pose2(0.6, -0.1, -20)), "goal.yaw: -20 rad degrees Pose2.deg"),
    "degrees of a tolerance": (lambda: changed(tolerance=pps.Tolerance(yaw=5.0)), "tolerance.yaw: 5 rad degrees"),
    "negative size": (lambda: pps.Box((0.1, -0.1, 0.1)), "size -0.1"),
    "size of one number": (lambda: pps.Box(0.1), "size 0.1 three lengths"),
    "size of text": (lambda: pps.Box(("0.1", 0.1, 0.1)), "size '0.1'"),
    "no size": (lambda: pps.Box(None), "size None"),
    "millimetres": (lambda: heavy(shape=pps.Box((100, 100, 100))), "object.shape.box[0]: 100 (0, 10]"),
    "radius of text": (lambda: pps.Cylinder("0.1", 0.1), "radius '0.1'"),
    "polygon of text": (lambda: pps.Prism("abc", 0.1), "polygon 'a'"),
    "polygon of numbers": (lambda: pps.Prism([0.1, 0.2, 0.3], 0.1), "polygon 0.1 (x, y)"),
    "compound of boxes": (lambda: pps.Compound((CUBE,)), "part Part"),
    "shape by a word": (lambda: heavy(shape="box"), "object.shape: 'box' prism"),
    "mass of text": (lambda: heavy(mass="0.5"), "object.mass: '0.5' number [kg]"),
    "mass of nothing": (lambda: heavy(mass=None), "object.mass missing"),
    "mass that is not a number": (lambda: heavy(mass=NAN), "mass nan"),
    "negative mass": (lambda: heavy(mass=-0.5), "mass -0.5"),
    "pose of text": (lambda: changed(goal=pps.Pose2("0.6", -0.1)), "goal.x: '0.6' number [m]"),
    "pose that is not a number": (lambda: changed(goal=pps.Pose2(NAN, -0.1)), "goal nan finite"),
    "pose of four": (lambda: changed(goal=(0.6, -0.1, 0.0, 0.0)), "goal: [0.6, -0.1, 0.0, 0.0] x, y, yaw_deg"),
    "pose of nothing": (lambda: changed(start=None), "start: None x, y, yaw_deg"),
    "pose with a wrong key": (lambda: changed(goal={"x": 0.6, "y": 0, "yaw_degrees": 1}), "goal.yaw_degrees did you mean 'yaw_deg'"),
    "pose in millimetres": (lambda: changed(goal=(600, -100, 0)), "goal.x: 600 [m]"),
    "robot misspelt": (lambda: changed(robots=["pandas"]), "robots[0].model: 'pandas' did you mean 'panda'"),
    "no robots": (lambda: changed(robots=None), "robots: None list"),
    "three robots": (lambda: changed(robots=["panda"] * 3), "robots 1 to 2"),
    "base of five numbers": (lambda: changed(robots=[pps.Robot("panda", base=range(5))]), "robots[0].base: [0, 1, 2, 3, 4] x, y"),
    "mode with a hyphen": (lambda: pps.plan(TASK, "rear-push"), "'rear-push' did you mean 'rear_push'"),
    "unknown mode": (lambda: pps.plan(TASK, "rear_psuh"), "rear_psuh did you mean 'rear_push'"),
    "unknown mode of a run": (lambda: run(mode="push"), "modes[0]: 'push' known: "),
    "mode by its number": (lambda: run(mode=1), "modes[0]: 1"),
    "choice by its number": (lambda: pps.plan(TASK, 0), "choice: 0 Choice"),
    "all choices": (lambda: pps.plan(TASK, pps.select(TASK)), "choice Choice"),
    "mode for two arms": (lambda: pps.plan(TASK, "orthogonal_push"), "robots 1 robot 2 robots"),
    "mode of a plan": (lambda: run(pps.plan(TASK), mode="rear_push"), "mode Plan"),
    "unknown engine": (lambda: run(engine="plana"), "engine: 'plana' planar drake"),
    "engine of nothing": (lambda: run(engine=None), "engine: None planar drake"),
    "seed of text": (lambda: run(seed="1"), "seed: '1' whole number"),
    "negative seed": (lambda: run(seed=-1), "seed: -1 0 or greater"),
    "unknown task": (lambda: pps.load_task("rear-push-raer"), "rear-push-raer did you mean 'rear-push-rear'"),
    "unknown file": (lambda: pps.load_task(Path("here/task.yaml")), "here/task.yaml no such file"),
    "task of nothing": (lambda: pps.load_task(None), "task: None a Task"),
    "task of a plan": (lambda: pps.select(pps.plan(TASK)), "task: Plan( a Task"),
    "task of a record": (lambda: run(3.0), "task: 3.0 a Task"),
    "task without an object": (lambda: pps.load_task({k: v for k, v in MINE.items() if k != "object"}), "mine: object: None missing"),
    "task with a wrong field": (lambda: pps.load_task({**MINE, "robot": "panda"}), "mine: robot did you mean 'robots'"),
    "motion of text": (lambda: moved(speed="slow"), "motion.speed: 'slow' [m/s] (0, 0.2]"),
    "too fast": (lambda: moved(speed=1.0), "motion.speed: 1.0 (0, 0.2]"),
    "face of a word": (lambda: moved(face="left"), "motion.face: 'left'"),
    "face of a fraction": (lambda: moved(face=1.5), "motion.face: 1.5 whole"),
    "arm misspelt": (lambda: moved(arm="rigth"), "motion.arm: 'rigth'"),
    "motion with a wrong field": (lambda: changed(motion={"sped": 0.1}), "motion.sped did you mean 'speed'"),
    "limits of a number": (lambda: changed(limits=60), "limits: 60 time"),
    "friction of text": (lambda: changed(contact_friction="0.5"), "contact.friction: '0.5'"),
    "friction of a percentage": (lambda: changed(contact_friction=60), "contact.friction: 60 (0, 2)"),
    "support by a word": (lambda: changed(support="table"), "support: 'table'"),
    "support misspelt": (lambda: changed(support=pps.Support(kind="tabel")), "support.kind: 'tabel'"),
    "obstacle without a pose": (lambda: changed(obstacles=[{"name": "post", "box": [0.1, 0.1, 0.1]}]), "obstacles[0].pose missing"),
    "obstacle by its shape": (lambda: changed(obstacles=[CUBE]), "obstacles[0]: Box( name"),
    "name with a space": (lambda: changed(name="my task"), "name: 'my task'"),
    "name of nothing": (lambda: changed(name=None), "name: None"),
    "goal in the arm": (lambda: changed(goal=(0.05, 0.0)), "goal robots[0].base"),
    "folder of no run": (lambda: pps.load_run("nowhere"), "nowhere"),
    "report of no run": (lambda: pps.report("nowhere"), "nowhere"),
    "models misspelt": (lambda: pps.run(TASK, models="drak"), "models: 'drak' generated"),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::pushpressslide.core.errors.TaskWarning")
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_refused_in_one_line_of_its_own(name: str) -> None:
    call, words = MISTAKES[name]
    with pytest.raises(pps.PushPressSlideError) as refused:
        call()
    line = str(refused.value)
    for words_of_it in words.split(" "):
        assert words_of_it in line
    assert "\n" not in line
    assert "--" not in line
    from_file = name.startswith(("override", "models"))
    assert from_file or "rear-push-rear.yaml" not in line


SLIPS: dict[str, tuple[Callable[[], Any], str]] = {
    "small degrees": (lambda: pps.Pose2(0.66, -0.2, -7.0), "yaw -7 rad .* degrees"),
    "degrees by replace": (lambda: replace(GOAL, yaw=90.0), "90 rad"),
    "grams": (lambda: heavy(mass=800.0), "800 kg in .* litres .* grams"),
}  # fmt: skip


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_warned_about_where_it_was_written(name: str) -> None:
    call, words = SLIPS[name]
    with pytest.warns(UserWarning, match=words) as warned:
        call()
    assert warned[0].filename == __file__


def test_a_yaw_that_the_package_computes_gives_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        turned = pps.Pose2(yaw=4.0).compose(pps.Pose2(yaw=4.0))
    assert turned.yaw == 8.0


@pytest.mark.parametrize(
    "part", [pps.Motion, pps.Limits, pps.Object, pps.Robot, pps.Task]
)
def test_help_has_every_field(part: Any) -> None:
    for name, field in part.__dataclass_fields__.items():
        if "entry" in field.metadata:
            assert f"        {name}" in part.__doc__


def test_help_has_units_and_ranges_of_a_program() -> None:
    words = " ".join(str(pps.Motion.__doc__).split())
    assert "speed [m/s] in (0, 0.2], default 0.05: speed of" in words
    assert "yaw [rad] in (0, 3.142], default 0.03491" in str(pps.Tolerance.__doc__)
