"""Growth of the cost of a law, a tick and a plan with problem size, stated as the
exponent of a power law.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.batch.two_contacts import TwoContacts
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Leg, ObjectModel, Obstacle, Prism, Task
from pushpressslide_studies.bench.compared import Row, times

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROUNDS = 5
BATCH = (1_000, 10_000, 100_000, 1_000_000)
LENGTHS = (0.1, 0.3, 1.0, 3.0)  # [m]
CORNERS = (3, 4, 6, 8, 12)
POSTS = (1, 2, 4, 8)
LEGS = (1, 2, 4, 8)
REPEATS = 300  # of what takes microseconds

Sized = Callable[[int | float], Callable[[], object]]
"""Function from a size to the function that is timed."""


def scaling(seed: int) -> list[Row]:
    """A row for each size of each problem: the median time, and the exponent over all
    sizes of that problem.
    """
    rng = np.random.default_rng(seed)
    studies: dict[str, tuple[Sequence[int | float], Sized, int]] = {
        "rows of a batch of two contacts": (BATCH, lambda n: _batch(rng, int(n)), 1),
        "length of a path, one tick [m]": (LENGTHS, _tick, REPEATS),
        "corners of an object, selection": (CORNERS, _selection, 1),
        "obstacles, free ways to a goal": (POSTS, _free_space_search, 1),
        "legs of a task, plan": (LEGS, _legs, 1),
    }
    rows = []
    for what, (sizes, sized, repeats) in studies.items():
        spent = {size: _median(sized(size), repeats) for size in sizes}
        slope = exponent(spent)
        rows += [
            {"what": what, "size": size, "median_us": 1e6 * time, "exponent": slope}
            for size, time in spent.items()
        ]
    return rows


def exponent(spent: Mapping[int | float, float]) -> float:
    """Exponent p of the power law c n^p fitted to times [s] by size n."""
    sizes = np.log(np.array(list(spent)))
    slope, _ = np.polyfit(sizes, np.log(np.array(list(spent.values()))), 1)
    return float(slope)


def _median(run: Callable[[], object], repeats: int) -> float:
    """Median time [s] of a call. The first call is not counted."""
    run()
    return statistics.median(times([(run, ())] * max(ROUNDS, repeats)))


def _batch(rng: np.random.Generator, rows: int) -> Callable[[], object]:
    pair = TwoContacts(
        ((-0.1, 0.06), (-0.1, -0.06)), ((1.0, 0.0), (1.0, 0.0)), 0.5, 0.08
    )
    wrenches = rng.normal(size=(rows, 3)) * (1.0, 1.0, 0.08)
    return lambda: pair.allocate(wrenches)


def _push() -> tuple[Task, Segment]:
    from pushpressslide.selection.solve import plan
    from pushpressslide.taskfile.load import load_task

    task = load_task("rear-push-rear")
    (segment,) = plan(task).segments
    return task, segment


def _tick(length: int | float) -> Callable[[], object]:
    """Tracking and allocation on a path of four arcs, near its middle."""
    from pushpressslide.modes import MODES

    task, segment = _push()
    quarter = 0.25 * length
    bend = 0.3 / length
    pieces = tuple((sign * bend, quarter) for sign in (1.0, -1.0, -1.0, 1.0))
    path = ArcPath(segment.path.pose(0.0), pieces)
    led = replace(segment, path=path, profile=SpeedProfile(path.length, 0.05, 0.1))
    tracker = MODES[segment.mode].tracker(task.query, led)
    allocate = MODES[segment.mode].allocator_of(led, task.scene.contact_friction)
    s = 0.5 * path.length
    X = path.pose(s).compose(Pose2(0.0, 0.002, 0.02)).compose(led.X_BV.inverse())

    def tick() -> object:
        wanted = tracker.step(path, X, s, 0.05, 1.0)
        return allocate(wanted.fx, wanted.fy, wanted.tau)

    return tick


def _task() -> Task:
    from pushpressslide.taskfile.load import load_task

    return replace(load_task("press-slide"), modes=None)


def _selection(corners: int | float) -> Callable[[], object]:
    """Selection for an object with the given number of faces."""
    from pushpressslide.selection.select import select

    turns = [2.0 * math.pi * i / corners for i in range(int(corners))]
    outline = tuple((0.09 * math.cos(a), 0.09 * math.sin(a)) for a in turns)
    shape = Prism(outline, 0.1)
    body = ObjectModel(shape, 1.0, (0.0, 0.0))
    task = replace(_task(), object=body)
    return lambda: select(task, 1)


def _free_space_search(posts: int | float) -> Callable[[], object]:
    """Search for the free paths of an object among posts."""
    from pushpressslide.selection.waypoints import free_space

    task = _task()
    around = [
        Pose2(0.5 + 0.35 * math.cos(a), 0.35 * math.sin(a), 0.0)
        for a in np.linspace(0.5, 2.6, int(posts)).tolist()
    ]
    obstacles = tuple(
        Obstacle(f"post-{i}", Box((0.05, 0.05, 0.2)), X) for i, X in enumerate(around)
    )
    among = replace(task, obstacles=obstacles).query
    return lambda: free_space(among).paths_to(among.goal).via_poses(among.start)


def _legs(count: int | float) -> Callable[[], object]:
    """Planning of the given number of legs, each a press slide, without joint paths."""
    from pushpressslide.selection.solve import plan
    from pushpressslide.taskfile.load import load_task

    tour = load_task("tour")
    ends = [goal.pose for goal in tour.goals[: int(count)]]
    legs = tuple(Leg("press_slide", end, tour.motion) for end in ends)
    task = replace(tour, goals=(), goal=ends[-1], legs=legs)
    return lambda: plan(task)


def figure(rows: Sequence[Row]) -> Figure:
    """Figure of the times over the sizes, with one panel per problem."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from pushpressslide.report import style

    names = list(dict.fromkeys(str(row["what"]) for row in rows))
    with mpl.rc_context(style.SETTINGS):
        made = Figure(figsize=(style.WIDTH, 8.0), dpi=style.DPI, layout="constrained")
        panels = made.subplots(math.ceil(len(names) / 2), 2).flat
    for axes in panels[len(names) :]:
        axes.set_axis_off()
    for name, axes in zip(names, panels, strict=False):
        mine = [row for row in rows if row["what"] == name]
        sizes = [row["size"] for row in mine]
        medians = [row["median_us"] for row in mine]
        axes.loglog(sizes, medians, "o-", color=style.BLUE)
        axes.set_xticks(sizes, [f"{size:,g}" for size in sizes])
        axes.minorticks_off()
        axes.set_ylim(*_decades(medians))
        axes.set_xlabel(name)
        axes.set_ylabel("median [us]")
        style.title(axes, f"grows with the power {mine[0]['exponent']:.2f}")
    return made


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Powers of ten below and above all values."""
    low = math.floor(math.log10(min(values)))
    high = math.ceil(math.log10(max(values)))
    return 10.0**low, 10.0 ** max(high, low + 1)
