"""Pictures of a run: only what moves is rendered anew, and an arm that hides a contact
or a goal is seen through.
"""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.geometry import Cylinder
from scipy.ndimage import maximum_filter

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.pose import Pose2
from pushpressslide.view.drake import fade, frames, light_shapes
from pushpressslide.view.drake.fade import (
    FAINT,
    HOLD,
    RATE,
    ArmOpacity,
    goal_targets,
    hides,
    smooth_opacity,
)
from pushpressslide.view.drake.frames import FrameRenderer
from pushpressslide.view.drake.sight import Limb, Moment

SMALL = (160, 90)


def renderer(run, size=SMALL):
    try:
        made = FrameRenderer(run.plan, run.record, size)
        made.image_at(0)
    except SimulationError as error:
        pytest.skip(str(error))
    return made


def link(height):
    """A link of an arm across the line from the origin to a camera at (0, -1, 1)."""
    return Moment((), (), (Limb((-0.5, -0.5, height), (0.5, -0.5, height), 0.06),))


def test_a_picture_after_a_move_is_that_of_a_new_renderer(arm_run):
    made = renderer(arm_run)
    made.image_at(100)
    after = made.image_at(400).astype(float)
    new = renderer(arm_run).image_at(400).astype(float)
    still = renderer(arm_run).image_at(0).astype(float)
    assert np.abs(after - new).mean() < 0.01
    assert np.abs(after - still).mean() > 0.1


def test_a_picture_of_nothing_new_is_not_rendered(arm_run, monkeypatch):
    made = renderer(arm_run)
    before = made.image_at(100).copy()
    monkeypatch.setattr(frames.Picture, "_render", None)
    assert np.array_equal(made.image_at(100), before)


def test_a_link_before_a_point_hides_it_from_the_camera():
    eye = np.array([0.0, -1.0, 1.0])
    contact = [((0.0, 0.0, 0.0),)]
    assert hides(link(0.5), contact, eye)
    assert not hides(link(0.7), contact, eye)
    behind = Moment((), (), (Limb((-0.5, 0.5, 0.0), (0.5, 0.5, 0.0), 0.06),))
    assert not hides(behind, contact, eye)
    beyond = Moment((), (), (Limb((-0.5, -1.5, 1.5), (0.5, -1.5, 1.5), 0.06),))
    assert not hides(beyond, contact, eye)


def test_a_goal_is_hidden_by_a_third_of_it_and_not_by_a_corner(run):
    (target,) = goal_targets([(run.task.object.shape, Pose2())])
    eye = np.array([0.0, -1.0, 1.0])
    half = max(y for _, y, _ in target)
    over = link(0.5)
    assert hides(over, [target], eye)
    (start,) = {limb.start for limb in over.limbs}
    past = Limb((start[0] + 0.49 + half, *start[1:]), (1.5, -0.5, 0.5), 0.001)
    assert not hides(Moment((), (), (past,)), [target], eye)


def test_an_arm_is_faint_all_the_time_that_it_hides_something_and_does_not_flicker():
    hidden = np.zeros((200, 1))
    hidden[50:120:3] = 1.0  # again and again
    opacity = smooth_opacity(hidden)[:, 0]
    assert np.allclose(opacity[50:119], FAINT)
    assert opacity[0] == opacity[-1] == 1.0
    gone = round((HOLD + 0.5) * RATE)
    assert np.allclose(opacity[: 50 - gone], 1.0)
    assert np.abs(np.diff(opacity)).max() < 0.2


def test_a_faint_arm_shows_what_is_behind_it_and_keeps_its_tip(arm_run, monkeypatch):
    clear = renderer(arm_run).image_at(200).astype(float)
    monkeypatch.setattr(fade.ArmOpacity, "of_tick", lambda self, tick: (FAINT,))
    faint = renderer(arm_run).image_at(200).astype(float)
    monkeypatch.setattr(fade.ArmOpacity, "of_tick", lambda self, tick: (0.0,))
    gone = renderer(arm_run).image_at(200).astype(float)
    assert np.abs(clear - gone).max() > 60.0
    mixed = FAINT * clear + (1.0 - FAINT) * gone
    assert np.abs(faint - mixed).max() < 2.0


def test_an_arm_straight_over_the_goal_is_faint_for_a_camera_above(arm_run):
    made = renderer(arm_run)
    context = made.playback.scene.plant.CreateDefaultContext()
    made.playback.set_plant(context, 0)
    links = fade.links_of_arm(made.playback, context, 0)
    x, y, _ = links.limbs[-1].start
    plan = replace(arm_run.plan, task=replace(arm_run.task, goal=Pose2(x, y)))
    playback = frames.Playback(plan, arm_run.record)
    above = ArmOpacity(playback, np.array([x, y, 3.0]))
    assert above.of_tick(200) == (pytest.approx(FAINT),)


def test_a_coarse_faint_arm_looks_like_a_sharp_one_and_leaves_the_rest_alone(
    arm_run, monkeypatch
):
    monkeypatch.setattr(fade.ArmOpacity, "of_tick", lambda self, tick: (FAINT,))
    size = (480, 270)
    sharp = renderer(arm_run, size).image_at(200).astype(float)
    made = FrameRenderer(arm_run.plan, arm_run.record, size, coarse=True)
    coarse = made.image_at(200).astype(float)
    monkeypatch.setattr(fade.ArmOpacity, "of_tick", lambda self, tick: (0.0,))
    gone = renderer(arm_run, size).image_at(200).astype(float)
    arm = np.abs(sharp - gone).max(axis=2) > 2.0
    margin = 2 * frames.COARSE
    near = maximum_filter(arm, 2 * margin + 1)
    off = np.abs(coarse - gone).max(axis=2) > 0.0
    assert off[~near].mean() < 1e-3  # lines of two scenes may differ by a pixel
    assert off[arm].mean() > 0.9
    assert np.abs(coarse - sharp).mean() < 0.3 * np.abs(sharp - gone).mean()


def test_a_cylinder_is_shaded_round_about_its_axis_and_flat_at_its_ends():
    mesh = light_shapes.ROUND[Cylinder](Cylinder(0.05, 0.2))
    along = np.abs(mesh.vertex_normals[:, 2])
    assert np.all((along < 1e-6) | (along > 1.0 - 1e-6))
    assert mesh.extents == pytest.approx([0.1, 0.1, 0.2], rel=0.01)
