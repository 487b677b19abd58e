"""Watching a run while it goes on: the scene in Meshcat, with goal and planned path, in
real time.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.scenes import Scene
from pushpressslide.sim.surfaces import object_shape
from pushpressslide.sim.view.playback import (
    GOAL_COLOR,
    GOAL_SINK,
    PATH_COLOR,
    PATH_HEIGHT,
    RIBBON_WIDTH,
    camera_view,
    leads_somewhere,
    ribbon,
)
from pushpressslide.sim.view.replay import FIELD, FRAMES_PER_SECOND, look, quiet_meshcat

SAMPLES = 100  # of the planned path of each stretch


class LiveView:
    """A page on this machine that shows the scene it is connected to; the simulation is
    the same without.
    """

    def __init__(self, plan: Plan, tell: Callable[[str], None]) -> None:
        """Start the page's server and ``tell`` its address."""
        self._meshcat: Meshcat = quiet_meshcat()
        look(self._meshcat)
        shares = np.linspace(0.0, 1.0, SAMPLES)
        places = []
        lines = []
        for stretch in plan.segments:
            grid = [float(u) for u in stretch.path.length * shares]
            places += [plan.object_pose(stretch, s) for s in grid]
            lines.append(np.array([stretch.path.pose(s).position for s in grid]))
        view = camera_view(
            plan.task, plan, np.array([(p.x, p.y, p.yaw) for p in places]), FIELD
        )
        self._meshcat.SetCameraPose(view.position, view.target)
        shape = plan.task.object.shape
        self._meshcat.SetObject("plan/goal", object_shape(shape), GOAL_COLOR)
        frame = plan.task.support.frame
        height = 0.5 * shape.height - GOAL_SINK
        self._meshcat.SetTransform(
            "plan/goal", rigid_transform(plan.task.goal, height, frame)
        )
        for i, line in enumerate(lines):
            if leads_somewhere(line):
                self._meshcat.SetObject(
                    f"plan/path_{i}", ribbon(line, RIBBON_WIDTH), PATH_COLOR
                )
                self._meshcat.SetTransform(
                    f"plan/path_{i}", rigid_transform(Pose2(), PATH_HEIGHT, frame)
                )
        tell(self._meshcat.web_url())

    def connect(self, builder: DiagramBuilder, scene: Scene) -> None:
        """Show the bodies of ``scene``, whose builder is not built yet, from then on."""
        parameters = MeshcatVisualizerParams()
        parameters.role = Role.kIllustration
        parameters.publish_period = 1.0 / FRAMES_PER_SECOND
        MeshcatVisualizer.AddToBuilder(
            builder, scene.scene_graph, self._meshcat, parameters
        )

    @staticmethod
    def pace(simulator: Simulator) -> None:
        """Let the simulation go no faster than real time, so that it can be watched."""
        simulator.set_target_realtime_rate(1.0)
