"""Replay of a run as one Meshcat page that opens offline."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    Meshcat,
    MeshcatParams,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    Role,
)

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.whole_file import write_whole
from pushpressslide.view.bar import filled, json_in_page, package_text
from pushpressslide.view.drake.camera import FIELD, FILL
from pushpressslide.view.drake.contact_marks import ContactMarks
from pushpressslide.view.drake.fade import FLANGE, Target, contact_targets, goal_targets
from pushpressslide.view.drake.marks import Marks
from pushpressslide.view.drake.playback import Placed, Playback
from pushpressslide.view.drake.saved_page import small_page
from pushpressslide.view.drake.subject import LINK_RADIUS
from pushpressslide.view.drake.views import PageView, page_views
from pushpressslide.view.film import LegendEntry
from pushpressslide.view.timeline import RunTimeline, frames, run_timeline

ROOM = "pushpressslide.view.drake"
KEY_STEP = 1e-3  # [s] to which times in the animation are rounded
# direction of the page's light along x, y and height of a table, and of a wall
LIGHT = (-0.5, 0.35, 1.0)
STEEP_LIGHT = (0.4, 0.9, 0.8)
SHADOW_ROOM = 0.6  # [m] about the near points in which shadows fall


def write_replay(
    plan: Plan,
    record: Record,
    out: Path,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> Path:
    """Write the page to the file ``out``, and return its path.

    If ``out`` is a folder, the file is replay.html. The page plays the recorded joint
    positions and poses, at most 30 per second. It is written completely or not at all.
    Raises SimulationError for a record without joint positions. ``models`` is as in
    ``run``, ``goals`` as in ``Playback``.
    """
    if len(record.arrays.get("time", ())) < 2:
        raise SimulationError(
            f"{out}: a record of fewer than two ticks cannot be replayed"
        )
    playback = Playback(plan, record, models, goals)
    ticks = frames(record.arrays["time"])
    views = page_views(playback, ticks)
    meshcat = quiet_meshcat()
    look(meshcat)
    contacts = ContactMarks(playback, np.array(views[0].direction))
    _animate(meshcat, contacts, ticks)
    body = _body(contacts, run_timeline(plan, record, ticks), views, ticks)
    page = small_page(
        meshcat.StaticHtml(), package_text("replay_head.html", ROOM), body
    )
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def _body(
    contacts: ContactMarks,
    timeline: RunTimeline,
    views: Sequence[PageView],
    ticks: NDArray[np.intp],
) -> str:
    """Fragments of the page around Meshcat's scene."""
    playback = contacts.playback
    modes = ", ".join(playback.record.modes)
    title = f"{playback.task.name}: {modes}, {timeline.ending}"
    return filled(
        package_text("replay.html", ROOM),
        {
            "STYLE": package_text("replay.css", ROOM),
            "SCRIPT": package_text("replay.js", ROOM) + package_text("fade.js", ROOM),
            "TITLE": escape(title),
            "LEGEND": "".join(map(_item, contacts.entries())),
            "COURSE": json_in_page(timeline.plain()),
            "VIEWS": json_in_page([view.plain() for view in views]),
            "LOOK": json_in_page(_look(playback, np.array(views[0].points), ticks)),
        },
    )


def _item(item: LegendEntry) -> str:
    return f'<li style="--c:{item.color}">{escape(item.text)}</li>'


def _look(
    playback: Playback, points: NDArray[np.float64], ticks: NDArray[np.intp]
) -> dict[str, Any]:
    """Parameters for the page: field of view [deg], light, extent of the shadows, and
    what arms may hide.
    """
    frame = playback.task.support.frame
    light = LIGHT if frame.faces_up else STEEP_LIGHT
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - center, axis=1).max()) + SHADOW_ROOM
    return {
        "field": math.degrees(FIELD),
        "fill": FILL,
        "light": list(frame.direction(light)),
        "center": [round(float(v), 3) for v in center],
        "radius": round(radius, 3),
        "hiding": _hiding(playback, ticks),
    }


def _hiding(playback: Playback, ticks: NDArray[np.intp]) -> dict[str, Any]:
    """Paths of each arm's links in Meshcat's tree, without the tip, and the points that
    they may hide.

    These are points [m] in the world of the goals and of the contacts at ``ticks``
    (F,).
    """
    frame = playback.task.support.frame

    def places(target: Target) -> list[list[float]]:
        points = map(frame.point, target)
        return [[round(float(v), 3) for v in point] for point in points]

    contacts = [contact_targets(playback, tick) for tick in ticks.tolist()]
    return {
        "arms": _link_paths(playback),
        "tips": _tip_paths(playback),
        "flange": FLANGE,
        "radius": LINK_RADIUS,
        "goals": [places(target) for target in goal_targets(playback.goals)],
        "contacts": [[places(tip)[0] for tip in tips] for tips in contacts],
    }


def _tip_paths(playback: Playback) -> list[list[str]]:
    """Path in Meshcat's tree of the body that holds each arm's tip."""
    return [paths[-1] for paths in _body_paths(playback)]


def _link_paths(playback: Playback) -> list[list[list[str]]]:
    """Paths in Meshcat's tree of each arm's links, from its base, without the tip."""
    return [paths[:-1] for paths in _body_paths(playback)]


def _body_paths(playback: Playback) -> list[list[list[str]]]:
    """Paths in Meshcat's tree of each arm's drawn bodies, from its base to its tip."""
    plant = playback.scene.plant
    inspector = playback.scene.scene_graph.model_inspector()
    arms = []
    for robot in playback.scene.robots:
        name = plant.GetModelInstanceName(robot.model_instance)
        stem = ["drake", "visualizer", *name.split("::")]
        bodies = plant.GetBodyIndices(robot.model_instance)
        drawn = [
            index
            for index in bodies
            if index == bodies[-1]
            or inspector.NumGeometriesForFrameWithRole(
                plant.GetBodyFrameIdOrThrow(index), Role.kIllustration
            )
        ]
        arms.append([[*stem, plant.get_body(index).name()] for index in drawn])
    return arms


def _animate(meshcat: Meshcat, contacts: ContactMarks, ticks: NDArray[np.intp]) -> None:
    """Record the run at ``ticks`` as an animation, with its marks."""
    playback = contacts.playback
    parameters = MeshcatVisualizerParams()
    parameters.role = Role.kIllustration
    parameters.publish_period = KEY_STEP
    scene = playback.scene
    visualizer = MeshcatVisualizer.AddToBuilder(
        scene.builder, scene.scene_graph, meshcat, parameters
    )
    diagram = scene.builder.Build()
    context = diagram.CreateDefaultContext()
    marks = Marks(meshcat, contacts, ticks)
    recording = visualizer.StartRecording(set_transforms_while_recording=False)
    recording.set_autoplay(False)
    time = playback.record.arrays["time"]
    for frame, tick in enumerate(ticks.tolist()):
        # half a step on, so that rounding down keeps the frame's time
        t = float(time[tick] - time[0]) + 0.5 * KEY_STEP
        context.SetTime(t)
        playback.set(context, tick)
        diagram.ForcedPublish(context)
        marks.show(frame, tick, t)
    visualizer.StopRecording()
    visualizer.PublishRecording()


def quiet_meshcat() -> Meshcat:
    """A Meshcat whose server listens only on this machine, and prints nothing."""
    log = logging.getLogger("drake")
    level = log.level
    log.setLevel(logging.WARNING)
    try:
        return Meshcat(MeshcatParams(host="localhost", port=0, show_stats_plot=False))
    finally:
        log.setLevel(level)


def look(meshcat: Meshcat) -> None:
    """Set a page's background and field of view, and hide Meshcat's grid and axes."""
    camera = Meshcat.PerspectiveCamera()
    camera.fov = math.degrees(FIELD)
    meshcat.SetCamera(camera)
    meshcat.SetProperty("/Grid", "visible", False)
    meshcat.SetProperty("/Axes", "visible", False)
    meshcat.SetProperty("/Background", "top_color", [0.93, 0.95, 0.97])
    meshcat.SetProperty("/Background", "bottom_color", [1.0, 1.0, 1.0])
