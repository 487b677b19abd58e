"""Live view of a run in Meshcat, with goal and planned path, in real time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydrake.geometry import (
    Meshcat,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    Rgba,
    Role,
    Shape,
)
from pydrake.math import RigidTransform
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.scenes import DrakeScene
from pushpressslide.sim.surfaces import drawn_shape
from pushpressslide.view.drake.lines import (
    PATH_HEIGHT,
    RIBBON_WIDTH,
    leads_somewhere,
    ribbon,
)
from pushpressslide.view.drake.planned import planned_view
from pushpressslide.view.drake.playback import GOAL_COLOR, GOAL_SINK, PATH_COLOR
from pushpressslide.view.drake.replay import look, quiet_meshcat
from pushpressslide.view.timeline import FRAMES_PER_SECOND

SAMPLES = 100  # of the planned path of each segment


class LiveView:
    """A page on this machine that shows a scene, and has no effect on the simulation."""

    def __init__(self, plan: Plan, tell: Callable[[str], None]) -> None:
        """Start the page's server and report its address by ``tell``."""
        self._meshcat: Meshcat = quiet_meshcat()
        look(self._meshcat)
        task = plan.task
        lines = []
        for segment in plan.segments:
            grid = np.linspace(0.0, 1.0, SAMPLES)
            lengths = [float(u) for u in segment.path.length * grid]
            lines.append(np.array([segment.path.pose(s).position for s in lengths]))
        view = planned_view(plan)
        self._meshcat.SetCameraPose(view.position, view.target)
        shape = task.object.shape
        frame = task.support.frame
        X_WG = rigid_transform(task.goal, 0.5 * shape.height - GOAL_SINK, frame)
        self._draw("plan/goal", drawn_shape(shape), X_WG, GOAL_COLOR)
        X = rigid_transform(Pose2(), PATH_HEIGHT, frame)
        for i, line in enumerate(lines):
            if leads_somewhere(line):
                strip = ribbon(line, RIBBON_WIDTH)
                self._draw(f"plan/path_{i}", strip, X, PATH_COLOR)
        tell(self._meshcat.web_url())

    def _draw(self, name: str, shape: Shape, X: RigidTransform, color: Rgba) -> None:
        self._meshcat.SetObject(name, shape, color)
        self._meshcat.SetTransform(name, X)

    def connect(self, builder: DiagramBuilder, scene: DrakeScene) -> None:
        """Show the bodies of ``scene``, whose builder is not built yet."""
        parameters = MeshcatVisualizerParams()
        parameters.role = Role.kIllustration
        parameters.publish_period = 1.0 / FRAMES_PER_SECOND
        MeshcatVisualizer.AddToBuilder(
            builder, scene.scene_graph, self._meshcat, parameters
        )

    @staticmethod
    def pace(simulator: Simulator) -> None:
        """Slow the simulation down to real time, so that it can be watched."""
        simulator.set_target_realtime_rate(1.0)
