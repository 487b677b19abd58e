"""The smallest change of one field that makes a refused task feasible, tested before it
is reported.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from pushpressslide.core.errors import InfeasibleTaskError, PushPressSlideError
from pushpressslide.core.motion import PLANNED_SHARE, Motion
from pushpressslide.core.plan import Choice
from pushpressslide.core.task import Task
from pushpressslide.taskfile.dump import task_data
from pushpressslide.taskfile.load import task_from_data

MOST_TRIED = 12
"""Largest number of modified tasks that are evaluated."""
UP = (1.1, 1.25, 1.5, 2.0, 3.0, 4.0)
"""Factors by which a limit is raised."""
DOWN = (0.75, 0.5, 0.25)
"""Factors by which a distance is reduced."""
SMALLER = (0.75, 0.5, 0.35, 0.25)
"""Factors by which a tip's radius is reduced."""
SHIFTS = (0.05, 0.1, 0.15, 0.2, 0.3)
"""Distances [m] by which a base is moved towards the object or away from it."""
TURNS = (10.0, 20.0, 30.0, 45.0, 60.0, 90.0)
"""Angles [deg] by which the goal is turned."""
SPARE = 1.02
"""Factor on a value named in a refusal, to leave a margin."""
PRESCRIBED = (
    "face",
    "contacts",
    "contact_height",
    "arm",
    "vehicle",
    "press_force",
    "cop",
    "look_ahead",
)
"""Fields of ``motion`` whose choice a task can leave to the mode."""
SMOOTH = {"friction", "smooth_tip", "leaning", "squeeze", "outside_cone", "steering"}
"""Codes of refusals that a tip with more friction may remove."""
LARGE = {"off_top", "tipping", "above_object", "no_faces", "hollow", "too_close"}
"""Codes of refusals that a smaller tip may remove."""
TURNED = {"turning", "turn", "outside_cone", "loop", "steering", "no_path", "tool_skew"}
"""Codes of refusals that another yaw at the goal may remove."""

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Remedy:
    """A change of one field, and a mode that can then do the task."""

    field: str
    value: Any  # in the task file's units
    text: str  # instruction, such as "raise limits.time to 140"
    mode: str

    def __str__(self) -> str:
        """One line of English."""
        return f"{self.text}: then {self.mode} can"


@dataclass(frozen=True)
class _Ladder:
    """Values of one field, from the smallest change to the largest. If one helps, so do
    all later ones.
    """

    path: Path
    values: tuple[Any, ...]
    text: str  # instruction, with {value} to fill in

    @property
    def field(self) -> str:
        return ".".join(map(str, self.path))


@contextmanager
def remedies_named(task: Task) -> Iterator[None]:
    """Context that appends a remedy to a refusal of ``task``, if there is one."""
    try:
        yield
    except InfeasibleTaskError as error:
        found = remedy(task, error.choices)
        if found is None:
            raise
        raise InfeasibleTaskError(
            f"{error}; {found}", f"{error.brief}; {found}", error.choices
        ) from None


def remedy(task: Task, refused: Sequence[Choice]) -> Remedy | None:
    """First change suggested by the ``refused`` choices that makes the task feasible,
    or None.

    At most ``MOST_TRIED`` changes are tried, without planning joint paths. None for a
    task with several goals, and if only joint paths are missing.
    """
    codes = {choice.refusal.code for choice in refused if choice.refusal is not None}
    if task.goals or not codes or "joint_path" in codes:
        return None
    trial = _Trial(task)
    for ladder in _ladders(task, refused, codes):
        found = _smallest(trial, ladder)
        if found is not None:
            return found
        if trial.left <= 0:
            break
    return None


class _Trial:
    """Evaluations of a task with one field changed."""

    def __init__(self, task: Task) -> None:
        self._data = task_data(task)
        self._source = task.source or task.name
        self.left = MOST_TRIED

    def mode(self, path: Path, value: Any) -> str | None:
        """Mode that can do the modified task, or None."""
        from pushpressslide.selection.select import placements

        self.left -= 1
        data = copy.deepcopy(self._data)
        place: Any = data
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value
        try:
            changed = task_from_data(data, self._source)
            groups = placements(changed.queries())
        except PushPressSlideError:
            return None
        best = [group[0] for group in groups]
        return best[0].mode if all(choice.feasible for choice in best) else None


def _smallest(trial: _Trial, ladder: _Ladder) -> Remedy | None:
    """Smallest change of a ladder that helps, found by bisection."""
    values = ladder.values
    modes: dict[int, str] = {}
    low, high = 0, len(values) - 1
    for start in sorted({0, high}):
        mode = trial.mode(ladder.path, values[start]) if trial.left > 0 else None
        if mode is not None:
            modes[start] = mode
            high = start
            break
    while modes and low < high and trial.left > 0:
        middle = (low + high) // 2
        mode = trial.mode(ladder.path, values[middle])
        if mode is None:
            low = middle + 1
        else:
            modes[middle] = mode
            high = middle
    if not modes:
        return None
    best = min(modes)
    text = ladder.text.format(value=_written(values[best]))
    return Remedy(ladder.field, values[best], text, modes[best])


def _written(value: Any) -> str:
    if isinstance(value, dict):
        inside = ", ".join(f"{key}: {_written(part)}" for key, part in value.items())
        return f"{{{inside}}}"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _ladders(
    task: Task, refused: Sequence[Choice], codes: set[str]
) -> Iterator[_Ladder]:
    """Yield the changes suggested by refusals.

    Prescribed fields come first, then fields named by a refusal, then the cell and the
    goal.
    """
    yield from _prescribed(task)
    yield from _forces(task, refused)
    if "time_limit" in codes:
        yield from _longer(_figures(refused, "time_limit"))
    pushes = [c for c in refused if all(one.kind == "side" for one in c.contacts)]
    for code in ("tipping", "above_object"):
        yield from _lower_contact(_figures(pushes, code))
    if "obstacle" in codes:
        yield _nearer_obstacles(task)
    if "workspace" in codes:
        text = "leave limits.workspace out"
        yield _Ladder(("limits", "workspace"), (None,), text)
    if codes & SMOOTH:
        yield _rougher(task)
    if codes & LARGE:
        yield from _smaller_tips(task)
    if "reach" in codes or "workspace" in codes:
        yield from _moved_bases(task, _figures(refused, "reach"))
    if codes & TURNED:
        yield from _turned_goals(task)


def _figures(refused: Sequence[Choice], code: str) -> list[tuple[float, float]]:
    """Figures and limits of the refusals with a given code, the nearest to feasible
    first.
    """
    out = []
    for choice in refused:
        reason = choice.refusal
        if reason is not None and reason.code == code and reason.figure is not None:
            out.append((reason.figure, reason.allowed or 0.0))
    return sorted(out, key=lambda pair: abs(pair[0] - pair[1]))


def _prescribed(task: Task) -> Iterator[_Ladder]:
    """Yield the removal of each prescribed field."""
    if task.modes is not None and not task.legs:
        yield _Ladder(("modes",), (None,), "leave modes out")
    usual = Motion()
    for name in PRESCRIBED:
        if getattr(task.motion, name) != getattr(usual, name):
            yield _Ladder(("motion", name), (None,), f"leave motion.{name} out")


def _forces(task: Task, refused: Sequence[Choice]) -> Iterator[_Ladder]:
    """Yield larger normal forces, those required by refusals first."""
    force = task.limits.normal_force
    asked = [
        figure / PLANNED_SHARE * SPARE
        for figure, _ in _figures(refused, "normal_force")
    ]
    bounded = any("limits.normal_force" in choice.reason for choice in refused)
    values = {_rounded_up(value) for value in asked if force < value < math.inf}
    if bounded:
        values |= {_rounded_up(factor * force) for factor in UP}
    if values:
        text = "raise limits.normal_force to {value} N"
        yield _Ladder(("limits", "normal_force"), tuple(sorted(values)), text)


def _longer(figures: Sequence[tuple[float, float]]) -> Iterator[_Ladder]:
    """Yield a longer time limit."""
    for figure, _ in figures[:1]:
        values = (float(math.ceil(SPARE * figure)),)
        yield _Ladder(("limits", "time"), values, "raise limits.time to {value} s")


def _lower_contact(figures: Sequence[tuple[float, float]]) -> Iterator[_Ladder]:
    """Yield lower contacts on the side."""
    allowed = max((bound for _, bound in figures), default=0.0)
    if allowed <= 0.0:
        return
    values = tuple(math.floor(1e3 * share * allowed) / 1e3 for share in (0.98, *DOWN))
    text = "set motion.contact_height to {value} m"
    yield _Ladder(("motion", "contact_height"), values, text)


def _nearer_obstacles(task: Task) -> _Ladder:
    """Smaller clearances."""
    values = tuple(round(task.motion.clearance * share, 4) for share in DOWN)
    text = "lower motion.clearance to {value} m"
    return _Ladder(("motion", "clearance"), values, text)


def _smaller_tips(task: Task) -> Iterator[_Ladder]:
    """Yield smaller tips, down to a quarter of the radius."""
    for i, robot in enumerate(task.robots):
        if robot.tip is None and robot.tip_frame is None:
            values = tuple(round(robot.tip_radius * share, 4) for share in SMALLER)
            text = f"lower robots.{i}.tip_radius to {{value}} m"
            yield _Ladder(("robots", i, "tip_radius"), values, text)


def _rougher(task: Task) -> _Ladder:
    """Tips with more friction."""
    path: Path = ("contact", "friction")
    friction = task.contact_friction
    if task.belief.contact_friction is not None:
        path = ("belief", "contact_friction")
        friction = task.belief.contact_friction
    values = tuple(round(factor * friction, 2) for factor in UP[:4])
    name = ".".join(map(str, path))
    return _Ladder(path, values, f"raise {name} to {{value}}")


def _moved_bases(
    task: Task, figures: Sequence[tuple[float, float]]
) -> Iterator[_Ladder]:
    """Yield bases moved towards the object's path, then away from it."""
    middle = (
        0.5 * (task.start.x + task.goal.x),
        0.5 * (task.start.y + task.goal.y),
    )
    short = [figure for figure, _ in figures[:1] if figure < SHIFTS[-1]]
    steps = tuple(sorted({*SHIFTS, *(SPARE * one + 0.01 for one in short)}))
    for sign in (1.0, -1.0):
        for i, robot in enumerate(task.robots):
            x, y, z = robot.base
            angle = math.atan2(middle[1] - y, middle[0] - x)
            along = (sign * math.cos(angle), sign * math.sin(angle))
            values = tuple(
                {
                    "x": round(x + step * along[0], 3),
                    "y": round(y + step * along[1], 3),
                    "z": z,
                    "yaw_deg": round(math.degrees(robot.base_yaw), 3),
                }
                for step in (steps if sign > 0.0 else SHIFTS[:3])
            )
            text = f"move robots.{i}.base to {{value}}"
            yield _Ladder(("robots", i, "base"), values, text)


def _turned_goals(task: Task) -> Iterator[_Ladder]:
    """Yield goals turned to either side."""
    yaw = math.degrees(task.goal.yaw)
    back = math.degrees(math.remainder(task.start.yaw - task.goal.yaw, math.tau))
    for sign in (1.0, -1.0) if back >= 0.0 else (-1.0, 1.0):
        values = tuple(round(yaw + sign * turn, 1) for turn in TURNS)
        yield _Ladder(("goal", "yaw_deg"), values, "turn goal.yaw_deg to {value}")


def _rounded_up(value: float) -> float:
    """``value`` rounded up to two significant digits."""
    size = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / size - 1e-9) * size
