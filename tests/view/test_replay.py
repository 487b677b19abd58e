"""Replay and frames show the recorded run, offline."""

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core.bodies import goal_places
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import (
    Box,
    Cylinder,
    ObjectModel,
    Obstacle,
    Prism,
    Support,
    ToolUse,
)
from pushpressslide.view.drake import frames, marks
from pushpressslide.view.drake.camera import FIELD, fit_view
from pushpressslide.view.drake.contact_marks import ContactMarks
from pushpressslide.view.drake.frames import look_at, render_frames
from pushpressslide.view.drake.lines import ribbon
from pushpressslide.view.drake.overlay import Overlay
from pushpressslide.view.drake.planned import planned_view
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.replay import write_replay
from pushpressslide.view.drake.run_film import FilmedRun, write_video
from pushpressslide.view.planar.replay import replay_data

PRISM = Prism(((-0.06, -0.05), (0.08, -0.05), (0.0, 0.09)), 0.06)


def two_arms(made, arm_run):
    """Two Pandas at rest beside the box that they press, for what is drawn."""
    robots = tuple(
        replace(arm_run.task.robots[0], base=(-0.2, y, 0.0)) for y in (0.4, -0.4)
    )
    task = replace(made.task, robots=robots)
    joints = {
        f"joint_position_{i}": arm_run.record.arrays["joint_position_0"] for i in (0, 1)
    }
    return replace(
        made.with_arrays(**joints),
        task=task,
        plan=replace(made.plan, task=task),
    )


def with_shape(run, shape):
    post = Obstacle("post", Box((0.1, 0.1, 0.2)), Pose2(0.3, 0.3, 0.3), movable=True)
    task = replace(
        run.task, object=ObjectModel(shape, 1.0, (0.0, 0.0)), obstacles=(post,)
    )
    return replace(run, task=task, plan=replace(run.plan, task=task))


def test_the_replay_is_one_page_of_a_few_megabytes_without_a_server(arm_run, tmp_path):
    page = write_replay(arm_run.plan, arm_run.record, tmp_path / "replay.html")
    text = page.read_text()
    assert 1e6 < len(text) < 5e6
    assert "by-hand: rear_push, goal reached" in text
    assert "@" not in text.rpartition('<div class="over">')[2]
    assert "localhost" not in text.split("</script>")[-1]
    assert "<script src=" not in text
    assert [p.name for p in tmp_path.iterdir()] == ["replay.html"]


@pytest.mark.parametrize(
    "shape", [PRISM, Cylinder(0.06, 0.07)], ids=["prism", "cylinder"]
)
def test_every_shape_can_be_replayed(arm_run, tmp_path, shape):
    made = with_shape(arm_run, shape)
    assert write_replay(made.plan, made.record, tmp_path / "replay.html").is_file()


def test_playback_puts_everything_where_it_was(arm_run):
    made = with_shape(arm_run, PRISM)
    playback = Playback(made.plan, made.record)
    diagram = playback.scene.builder.Build()
    context = diagram.CreateDefaultContext()
    tick = 300
    playback.set(context, tick)
    plant = playback.scene.plant
    inner = plant.GetMyContextFromRoot(context)
    X = plant.EvalBodyPoseInWorld(inner, playback.scene.object)
    assert X.translation()[:2] == pytest.approx(
        made.record.arrays["object_pose"][tick, :2]
    )
    q = plant.GetPositions(inner, playback.scene.robots[0].model_instance)
    assert q == pytest.approx(made.record.arrays["joint_position_0"][tick])
    post = plant.EvalBodyPoseInWorld(inner, playback.scene.bodies["post"])
    assert post.translation() == pytest.approx([0.3, 0.3, 0.1])


def test_a_planar_record_with_an_arm_is_refused_in_one_line(arm_run, tmp_path):
    arrays = {
        k: v for k, v in arm_run.record.arrays.items() if not k.startswith("joint_")
    }
    record = replace(arm_run.record, arrays=arrays, engine="planar")
    with pytest.raises(SimulationError, match="no joint_position_0") as caught:
        write_replay(arm_run.plan, record, tmp_path / "replay.html")
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("aspect", [9 / 16, 1.0, 16 / 9])
def test_the_camera_holds_every_point_and_fills_its_picture(aspect):
    points = np.random.default_rng(3).uniform(-0.5, 0.7, (50, 3))
    view = fit_view(points, np.array([0.6, -0.8, 0.6]), FIELD, aspect)
    seen = (look_at(view).inverse() @ points.T).T
    assert np.all(seen[:, 2] > 0.0)
    edge = np.tan(0.5 * FIELD)
    across = np.abs(seen[:, 0] / seen[:, 2]).max() / (edge * aspect)
    down = np.abs(seen[:, 1] / seen[:, 2]).max() / edge
    assert max(across, down) < 1.0
    assert max(across, down) > 0.75


def test_a_ribbon_has_the_width_that_was_asked_for():
    text = (
        ribbon(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), 0.01)
        .source()
        .in_memory()
        .mesh_file.contents()
    )
    rows = [
        line.split()[1:] for line in text.decode().splitlines() if line.startswith("v ")
    ]
    y = np.array(rows, dtype=float)[:, 1]
    assert sorted(set(y)) == pytest.approx([-0.005, 0.005])


def test_frames_show_the_object_move(arm_run, tmp_path):
    try:
        paths = render_frames(
            arm_run.plan,
            arm_run.record,
            (0.0, 4.0),
            tmp_path,
            size=(160, 120),
        )
    except SimulationError as error:
        pytest.skip(str(error))
    from PIL import Image

    first, last = (np.asarray(Image.open(path), dtype=float) for path in paths)
    assert first.shape == (120, 160, 3)
    assert np.abs(first - last).max() > 50.0


def test_a_machine_that_cannot_render_says_so_in_one_line(
    arm_run, tmp_path, monkeypatch
):
    monkeypatch.setattr(frames, "egl_problem", lambda: "libEGL.so.1 is missing")
    with pytest.raises(
        SimulationError, match=r"cannot render pictures \(libEGL\.so\.1 is missing\)"
    ) as caught:
        render_frames(arm_run.plan, arm_run.record, (0.0,), tmp_path)
    assert "\n" not in str(caught.value)


def test_a_video_of_an_unknown_kind_is_refused(arm_run, tmp_path):
    with pytest.raises(SimulationError, match=r"\.webp or \.gif"):
        write_video(FilmedRun(arm_run.plan, arm_run.record), tmp_path / "run.avi")


def test_a_video_is_written_whole(arm_run, tmp_path):
    out = tmp_path / "run.webp"
    run = FilmedRun(arm_run.plan, arm_run.record, size=(80, 60), rate=2.0)
    try:
        write_video(run, out)
    except SimulationError as error:
        pytest.skip(str(error))
    from PIL import Image

    assert Image.open(out).n_frames == 10
    assert Image.open(out).size == (80, 60)
    assert [p.name for p in tmp_path.iterdir()] == ["run.webp"]


def test_the_axle_is_that_of_the_segment_that_is_followed(pressed, arm_run):
    made = two_arms(pressed, arm_run)
    playback = Playback(made.plan, made.record)
    first = playback.vehicle_pose(100)
    last = playback.vehicle_pose(400)
    assert first.position == pytest.approx(
        made.plan.segments[0].path.pose(made.record.arrays["progress"][100]).position
    )
    assert last.position == pytest.approx(made.plan.segments[1].path.end.position)


def test_both_arms_are_drawn_with_their_forces_in_the_plane_and_presses(
    pressed, arm_run, tmp_path, monkeypatch
):
    made = two_arms(pressed, arm_run)
    drawn = {}

    def show(self, name, arrow, t):
        drawn.setdefault(name, []).append(arrow)

    monkeypatch.setattr(marks.Marks, "_show_arrow", show)
    text = write_replay(made.plan, made.record, tmp_path).read_text()
    assert "press, beside its tip, 10 mm a newton" in text
    assert sorted(drawn) == [
        "marks/force_0",
        "marks/force_1",
        "marks/press_0",
        "marks/press_1",
    ]
    press = drawn["marks/press_1"][60]
    assert press.force == pytest.approx([0.0, 0.0, -10.0])
    assert press.head[2] == pytest.approx(0.08)  # ends on the object's top
    assert drawn["marks/force_1"][60].size == pytest.approx(np.sqrt(5.0))


def test_the_live_camera_sees_the_whole_object_at_start_and_goal(run):
    bar = replace(run.task, object=ObjectModel(Box((0.6, 0.1, 0.05)), 1.0, (0.0, 0.0)))
    plan = replace(run.plan, task=bar)
    view = planned_view(plan, aspect=1.0)
    corners = [
        (*X_WG.apply(c), z)
        for X_WG in (bar.start, bar.goal)
        for c in bar.object.shape.corners
        for z in (0.0, 0.05)
    ]
    seen = (look_at(view).inverse() @ np.array(corners).T).T
    assert np.abs(seen[:, 1] / seen[:, 2]).max() < np.tan(0.5 * FIELD)
    assert np.abs(seen[:, 0] / seen[:, 2]).max() < np.tan(0.5 * FIELD)


@pytest.mark.parametrize("kind", ["table", "wall"])
def test_light_falls_on_the_face_of_the_support_from_above(kind):
    wall = SupportFrame.of_wall((0.86, 0.0, 0.81), np.pi)
    support = Support() if kind == "table" else Support(kind="wall", frame=wall)
    light = np.array(frames._light(support))
    out = support.frame.direction((0.0, 0.0, 1.0))
    assert -light @ out > 0.5 * np.linalg.norm(light)
    assert light[2] < -0.5 * np.linalg.norm(light)


def test_marks_over_a_picture_are_where_the_scene_has_them(arm_run):
    playback = Playback(arm_run.plan, arm_run.record)
    view = fit_view(np.array([(0.2, -0.3, 0.0), (0.8, 0.3, 0.2)]), np.array([1, 1, 1]))
    overlay = Overlay(playback, view, (1280, 720))
    assert overlay.pixel(tuple(view.target.tolist())) == pytest.approx((640.0, 360.0))
    above = view.target + np.array([0.0, 0.0, 0.05])
    right, down = overlay.pixel(tuple(above.tolist()))
    assert right == pytest.approx(640.0)
    assert down < 350.0


def test_the_goal_of_the_body_that_a_tool_pushes_is_drawn_too(run):
    cube = Obstacle("cube", Box((0.08, 0.08, 0.08)), Pose2(0.5, 0.2), movable=True)
    tool = ToolUse("cube", Pose2(0.6, 0.3, 0.0), 1, 0.1)
    task = replace(run.task, obstacles=(cube,), tool=tool)
    assert [(name, X) for name, _, X in goal_places(task)] == [
        ("object", task.goal),
        ("cube", tool.goal),
    ]
    plan = replace(run.plan, task=task)
    assert len(replay_data(plan, run.record)["goals"]) == 2


def test_the_force_of_a_push_begins_at_its_contact_and_stays_in_its_cone(arm_run):
    marks = ContactMarks(
        Playback(arm_run.plan, arm_run.record), np.array([1.0, 0.0, 1.0])
    )
    tick = 200
    arrow = marks.push(0, tick)
    apex, height = marks.cone(0, tick)
    assert arrow.tail[:2] == pytest.approx(apex.position)
    assert arrow.tail[2] > height > marks.height  # over the object, where it is seen
    tip = arm_run.record.arrays["tip_position"][tick, 0, :2]
    radius = arm_run.task.robots[0].tip_radius
    assert np.linalg.norm(arrow.tail[:2] - tip) == pytest.approx(radius)
    x, y = apex.inverse().rotate(tuple(arrow.force[:2]))
    assert abs(y) < marks.friction * x
    assert marks.cone(0, 0) is None  # no force yet
    assert marks.disc(0, tick) is None


def test_the_shear_of_a_press_ends_in_its_friction_disc(pressed, arm_run):
    made = two_arms(pressed, arm_run)
    marks = ContactMarks(Playback(made.plan, made.record), np.array([1.0, 0.0, 1.0]))
    for arm in (0, 1):
        disc = marks.disc(arm, 200)
        head = marks.push(arm, 200).head
        assert np.hypot(head[0] - disc.x, head[1] - disc.y) < disc.radius
        assert marks.cone(arm, 200) is None
