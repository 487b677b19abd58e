"""Recordings of a known object, as sensors make them, give back what is true of it.

The oracle is a quasi-static box in tests/identification/conftest.py.
"""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide import load_task, plan
from pushpressslide.cli import app
from pushpressslide.identification.clock_offset import ClockOffset
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.logs import log_files, read_logs
from pushpressslide.identification.pairs import Pairs
from pushpressslide.identification.push_sets import PushSet
from pushpressslide.identification.push_windows import PushedWindows
from pushpressslide.identification.recorded_sets import recorded_set, tip_friction
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_pole

FRICTION = 0.34
RHO = 0.055
LATE = 0.02


@pytest.fixture(scope="module")
def task(box_task: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("task") / "box.yaml"
    path.write_text(box_task)
    return path


def found(data: Path, task: Path, out: Path, *options: str) -> dict:
    args = ["identify", str(data), "--task", str(task), "--out", str(out)]
    result = CliRunner().invoke(app, [*args, "--splits", "2", "--json", *options])
    assert result.exit_code == 0, result.stderr
    (figures,) = json.loads(result.stdout)["sets"].values()
    return figures


def check_values(figures: dict) -> None:
    """Friction within 3 %, rho within 5 %, the offset within 3 ms, as the intervals
    say.
    """
    assert figures["friction"] == pytest.approx(FRICTION, rel=0.03)
    assert figures["rho"] == pytest.approx(RHO, rel=0.05)
    (clock,) = figures["clocks"]
    assert clock["offset"] == pytest.approx(-LATE, abs=0.003)
    assert abs(clock["offset"] + LATE) < 1.5 * clock["half_width"] < 0.006


def test_a_csv_in_the_long_form_gives_friction_rho_and_offset_and_a_task_that_plans(
    ellipsoid_pushes, long_form: Callable[..., str], task: Path, tmp_path: Path
) -> None:
    data = tmp_path / "pushes.csv"
    data.write_text(long_form(ellipsoid_pushes))
    own = tmp_path / "box.yaml"
    own.write_text(task.read_text())
    figures = found(data, own, tmp_path / "out", "--write", str(own))
    check_values(figures)
    low, high = figures["rho_interval"]
    assert low < figures["rho"] < high
    belief = load_task(own).belief
    assert belief.rho == pytest.approx(RHO, rel=0.05)
    assert belief.support_friction == pytest.approx(FRICTION, rel=0.03)
    assert 0.0 < belief.friction_error < 0.05
    assert own.read_text().startswith(task.read_text())
    assert plan(load_task(own)).segments
    assert (tmp_path / "out" / "report.html").is_file()


def test_a_shape_that_predicts_the_pushes_itself_needs_no_rho(
    even_pushes, long_form: Callable[..., str], task: Path, tmp_path: Path
) -> None:
    data = tmp_path / "pushes.csv"
    data.write_text(long_form(even_pushes))
    figures = found(data, task, tmp_path / "out")
    assert figures["friction"] == pytest.approx(FRICTION, rel=0.03)
    expected = rho_pole(support_pressure(load_task(task).object.shape))
    assert figures["rho_pressure"] == pytest.approx(expected, rel=0.05)
    assert figures["belief"]["rho"] is None
    assert figures["errors"]["pressure"]["mean"] < math.radians(3.0)


def test_streams_may_lie_in_several_files_of_their_own_columns_and_units(
    ellipsoid_pushes, task: Path, tmp_path: Path
) -> None:
    pushes = ellipsoid_pushes
    np.savetxt(
        tmp_path / "mocap.csv",
        np.column_stack(
            [1e3 * pushes.pose_times, 1e3 * pushes.poses[:, :2], pushes.poses[:, 2]]
        ),
        delimiter=";",
        header="stamp_ms;Body 1 X;box.y_mm;theta",
        comments="",
    )
    np.savetxt(
        tmp_path / "tip.csv",
        np.column_stack([pushes.times, pushes.tips]),
        delimiter=",",
        header="time,ee_x,ee_y,ee_z",
        comments="",
    )
    np.savetxt(
        tmp_path / "ft.csv",
        np.column_stack([pushes.times, -1e3 * pushes.forces]),
        delimiter=",",
        header="# a sensor\ntime,force.x (mN),force.y (mN)",
        comments="",
    )
    options = (
        "--column",
        "object_x=Body 1 X",
        "--unit",
        "object=mm",
        "--force-on",
        "tip",
    )
    check_values(found(tmp_path, task, tmp_path / "out", *options))


def test_a_run_is_a_recording_of_its_own_task(tmp_path: Path) -> None:
    run = tmp_path / "run"
    args = ["run", "rear-push-rear", "--engine", "planar", "--out", str(run), "--quiet"]
    assert CliRunner().invoke(app, args).exit_code == 0
    (record,) = log_files([run])
    scene = load_task("rear-push-rear").scene
    made = recorded_set("run", read_logs([record], LogOptions()), scene, LogOptions())
    pairs = made.push_set.pairs
    level = np.hypot(*pairs.wrenches[:, :2].T) / made.push_set.weight
    # a straight push needs mu N, a turning one less
    assert np.percentile(level, 95.0) == pytest.approx(scene.support.friction, rel=0.03)
    assert abs(made.clocks[0].offset.seconds) < 0.003


def test_runs_of_different_objects_are_not_one_set(tmp_path: Path) -> None:
    for name, side in (("a", 0.15), ("b", 0.16)):
        args = ["run", "rear-push-rear", "--engine", "planar", "--quiet"]
        shape = f"object.shape={{box: [{side}, 0.15, 0.15]}}"
        where = ["--out", str(tmp_path / name), "--set", shape]
        assert CliRunner().invoke(app, [*args, *where]).exit_code == 0
    result = CliRunner().invoke(app, ["identify", str(tmp_path)])
    assert "allowed: runs of one object" in result.stderr


def one_set(text: str, tmp_path: Path, task: Path, **options: object) -> PushSet:
    path = tmp_path / "pushes.csv"
    path.write_text(text)
    log = LogOptions(**options)
    return recorded_set(
        "a", read_logs([path], log), load_task(task).scene, log
    ).push_set


def test_a_window_is_left_out_where_poses_are_missing_and_said(
    ellipsoid_pushes, long_form: Callable[..., str], tmp_path: Path, task: Path
) -> None:
    whole = one_set(long_form(ellipsoid_pushes), tmp_path, task)
    lines = long_form(ellipsoid_pushes).splitlines()
    poses = ellipsoid_pushes.poses[:, :2]
    fastest = np.argmax(np.linalg.norm(poses[10:] - poses[:-10], axis=1))
    first = ellipsoid_pushes.pose_times[fastest]
    gone = [
        first < float(line.split(",")[0]) < first + 0.35 and line.endswith(",,,,,")
        for line in lines[1:]
    ]
    left = [lines[0], *(x for x, g in zip(lines[1:], gone, strict=True) if not g)]
    cut = one_set("\n".join(left), tmp_path, task)
    assert len(cut.pairs) < len(whole.pairs)
    assert any("a gap of over 0.25 s" in line for line in cut.refused)


@pytest.mark.parametrize(
    ("old", "new", "options", "message"),
    [
        ("t [s],", "when,", (), "column time is missing; its columns: when, object_x"),
        ("object_yaw [deg]", "spin", (), "column object_yaw is missing"),
        (",fx,fy", ",gx,gy", (), "force missing; needed: object x y yaw"),
        ("object_x [mm]", "x [furlong]", (), "unit 'furlong' is not allowed"),
        ("object_x [mm]", "object_x [m]", (), "the tip never comes within"),
        ("object_yaw [deg]", "object_yaw", (), "--unit yaw=deg"),
        ("t [s]", "t [min]", (), "unit 'min' is not allowed; allowed: s, sec, ms"),
        ("", "", ("--unit", "object_yaw=rad"), "of the shape's side in"),
        ("object_x [mm],object_y [mm]", "object_y [mm],object_x [mm]", (), "frame G"),
        ("tip_z,fx", "fx [N],fx", (), "both hold tip_fx"),
        (",fx,fy", ",fx [kN],fy [kN]", (), "--unit force=N"),
        (",fx,fy", ",fy,fx", (), "degrees off the normal"),
        ("", "", ("--force-on", "tip"), "--force-on tip reads the force on the tip"),
        ("", "", ("--force-frame", "tip"), "column tip_yaw is missing"),
        ("", "", ("--column", "object_x=Xx"), "column object_x is missing"),
        ("", "", ("--column", "weight=fx"), "--column weight=fx: allowed: time"),
        ("", "", ("--unit", "mass=kg"), "--unit mass=kg: allowed: time"),
        ("", "", ("--unit", "mass"), "--unit mass: allowed: object=mm"),
        ("", "", ("--offset", "100"), "the streams have no time in common"),
    ],
)
def test_names_units_and_frames_that_cannot_be_are_refused(
    old: str,
    new: str,
    options: tuple[str, ...],
    message: str,
    ellipsoid_pushes,
    long_form: Callable[..., str],
    task: Path,
    tmp_path: Path,
) -> None:
    line = refused(
        long_form(ellipsoid_pushes).replace(old, new, 1), task, tmp_path, *options
    )
    assert message in line


def refused(text: str, task: Path, tmp_path: Path, *options: str) -> str:
    path = tmp_path / "pushes.csv"
    path.write_text(text)
    args = ["identify", str(path), "--task", str(task), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, [*args, *options])
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    return line


def test_a_cell_a_row_and_a_time_are_refused_with_their_line(
    ellipsoid_pushes, long_form: Callable[..., str], task: Path, tmp_path: Path
) -> None:
    lines = long_form(ellipsoid_pushes).splitlines()
    pose = next(i for i, line in enumerate(lines) if line.endswith(",,,,,"))
    time, x, y, yaw, *rest = lines[pose].split(",")

    def changed(line: str) -> str:
        text = "\n".join([*lines[:pose], line, *lines[pose + 1 :]])
        return refused(text, task, tmp_path)

    where = f"line {pose + 1}: "
    assert where + "column 'object_y [mm]': 'oops'" in changed(
        ",".join([time, x, "oops", yaw, *rest])
    )
    assert where + "column 'object_yaw [deg]' is empty" in changed(
        ",".join([time, x, y, "", *rest])
    )
    assert where + "it has no time" in changed(",".join(["", x, y, yaw, *rest]))
    assert f"{where}4 cells; allowed: 9" in changed(",".join([time, x, y, yaw]))
    late = refused("\n".join([*lines, lines[pose]]), task, tmp_path)
    assert f"line {len(lines) + 1}: time" in late
    assert "is not after" in late
    assert "needed: object x y yaw" in refused("a,b\n1,2\n", task, tmp_path)
    assert "has 1 lines" in refused("t,x\n", task, tmp_path)


def test_a_tip_that_slides_along_a_face_shows_its_friction() -> None:
    generator = np.random.default_rng(0)
    n = 24
    # at the edge of its cone where it slides, inside where it sticks
    ratio = np.where(np.arange(n) % 2, 0.25, 0.1)
    wrenches = np.column_stack([np.full(n, 3.0), 3.0 * ratio, np.zeros(n)])
    twists = generator.normal(size=(n, 3))
    pairs = Pairs(wrenches, twists, np.zeros((n, 2)), np.zeros(n))
    windows = PushedWindows(
        pairs,
        np.arange(n),
        ClockOffset(0.0),
        np.tile((1.0, 0.0), (n, 1)),
        np.where(np.arange(n) % 2, 0.006, 0.001),
        (),
        (),
    )
    assert tip_friction([windows]) == pytest.approx((0.25, 0.25))
    at_rest = replace(windows, travels=np.zeros(n))
    assert tip_friction([at_rest]) == (None, pytest.approx(0.25))


def test_times_in_milliseconds_without_a_unit_are_refused(
    ellipsoid_pushes, long_form: Callable[..., str], task: Path, tmp_path: Path
) -> None:
    head, *lines = long_form(ellipsoid_pushes).splitlines()
    cells = [line.split(",", 1) for line in lines]
    slow = [f"{1e3 * float(time):.3f},{rest}" for time, rest in cells]
    text = "\n".join([head.replace("t [s]", "t"), *slow])
    assert "--unit time=ms" in refused(text, task, tmp_path)


def test_two_samples_are_too_few(task: Path, tmp_path: Path) -> None:
    text = (
        "time,tip_x,tip_y,fx,fy,obj_x,obj_y,obj_yaw\n"
        "0,0.30,0,1.9,0.1,0.35,0,0\n0.1,0.31,0,2,0.1,0.36,0,0.01\n"
    )
    assert "object: 2 samples; at least 10" in refused(text, task, tmp_path)


def test_a_file_without_a_task_and_a_shipped_task_to_write_are_refused(
    ellipsoid_pushes, long_form: Callable[..., str], tmp_path: Path
) -> None:
    path = tmp_path / "pushes.csv"
    path.write_text(long_form(ellipsoid_pushes))
    args = ["identify", str(path), "--out", str(tmp_path / "out")]
    assert "--task is missing" in CliRunner().invoke(app, args).stderr
    line = CliRunner().invoke(app, [*args, "--write", "rear-push-rear"]).stderr
    assert "pps show rear-push-rear > rear-push-rear.yaml" in line
