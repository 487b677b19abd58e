"""The result.json of a run with stages: figures of each stage, the final pose of every
body, and figures of all stages together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import groupby
from typing import Any

from pushpressslide.core.bodies import OBJECT, Stage, start_state
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Ending
from pushpressslide.core.task import Task
from pushpressslide.core.true_task import true_task
from pushpressslide.report.json_text import plain
from pushpressslide.report.outcome import (
    finished,
    goal_error,
    is_within,
    tolerance_figures,
)
from pushpressslide.report.stages import StageRun, final_poses

Figures = Mapping[str, Any]

SUMS = (
    "duration",
    "motion_duration",
    "path_length",
    "contact_loss_time",
    "slip_distance",
    "wall_time",
    "late_ticks",
)
LARGEST = (
    "max_position_error",
    "max_yaw_error",
    "path_max_error",
    "max_normal_force",
    "max_mean_normal_force",
    "max_force_without_stop",
    "max_tilt_deg",
    "support_gap_max",
    "max_torque_share",
    "max_torque_rate_share",
    "max_joint_speed_share",
)
LEAST = ("joint_limit_margin", "clearance_driven")
ROOT_MEAN_SQUARES = (
    "rms_position_error",
    "rms_yaw_error",
    "rms_end_effector_error",
    "path_rms_error",
)
SHARES = (
    "cone_violation_fraction",
    "torque_limit_violation_fraction",
    "torque_rate_saturated_fraction",
)
LISTS = ("contacts", "pivots")


def staged_result(
    task: Task,
    stages: Sequence[Stage],
    runs: Sequence[StageRun],
    results: Sequence[Figures],
    shortfall: Ending | None,
) -> dict[str, Any]:
    """Contents of result.json for a run of a task with goals, in ``stages``.

    ``runs`` are the started stages and ``results`` their results. ``shortfall`` is the
    reason why a stage was not started. A figure of several stages is their sum, their
    worst value, or their mean over the time in contact. Figures that make sense only
    for a single motion are given only with its stage.
    """
    out: dict[str, Any] = dict.fromkeys(results[0])
    same = ("schema", "engine", "seed", "time_step", "control_period", "versions")
    for name in same:
        out[name] = results[0][name]
    out |= _combined(results)
    bodies = _bodies(task, runs)
    worst = _worst(task, bodies)
    found = (task, runs, results, bodies)
    ended = shortfall or _ending(*found)
    truly = shortfall or _ending(*found, truly=True)
    to_goals = [
        result["verified"]
        for run, result in zip(runs, results, strict=True)
        if not run.stage.aside
    ]
    out |= {
        "task": task.name,
        "modes": [m for m, _ in groupby(m for r in results for m in r["modes"])],
        "success": truly.code == "goal_reached",
        "verified": len(runs) == len(stages) and all(to_goals),
        "reason": {"code": ended.code, "text": ended.text},
        "final_position_error": worst[0],
        "final_yaw_error": worst[1],
        "tolerance": tolerance_figures(task.tolerance),
        "planning_time": _planning_time(results),
        "events": _events(runs, results),
        "bodies": bodies,
        "stages": [
            {**stage_figures(run), "figures": _without_stages(result)}
            for run, result in zip(runs, results, strict=True)
        ]
        + [stage_to_do(stage) for stage in stages[len(runs) :]],
    }
    cleaned: dict[str, Any] = plain(out)
    return cleaned


def _without_stages(result: Figures) -> dict[str, Any]:
    return {name: value for name, value in result.items() if name != "stages"}


def _values(results: Sequence[Figures], name: str) -> list[float]:
    values = (result.get(name) for result in results)
    return [value for value in values if value is not None]


def _combined(results: Sequence[Figures]) -> dict[str, Any]:
    """Combined figures of several stages."""
    out: dict[str, Any] = {}
    paths: tuple[tuple[tuple[str, ...], Callable[[list[float]], float]], ...] = (
        (SUMS, math.fsum),
        (LARGEST, max),
        (LEAST, min),
    )
    for names, combine in paths:
        for name in names:
            values = _values(results, name)
            out[name] = combine(values) if values else None
    for name in ROOT_MEAN_SQUARES:
        mean = _mean(results, name, 2.0)
        out[name] = None if mean is None else math.sqrt(mean)
    for name in SHARES:
        out[name] = _mean(results, name, 1.0)
    for name in LISTS:
        out[name] = [
            {**item, "stage": number}
            for number, result in enumerate(results)
            for item in result.get(name) or ()
        ]
    for result in results:
        if result.get("clearance_driven") == out["clearance_driven"]:
            out["clearance_pair"] = result.get("clearance_pair")
            break
    wall_time = out["wall_time"]
    out["realtime_factor"] = out["duration"] / wall_time if wall_time else None
    return out


def _mean(results: Sequence[Figures], name: str, power: float) -> float | None:
    """Mean of a figure's ``power``, weighted by the time in contact."""
    pairs = [
        (result[name], result["motion_duration"])
        for result in results
        if result.get(name) is not None and result["motion_duration"]
    ]
    whole = sum(weight for _, weight in pairs)
    if not whole:
        return None
    mean: float = sum(weight * value**power for value, weight in pairs) / whole
    return mean


def _bodies(task: Task, runs: Sequence[StageRun]) -> dict[str, Any]:
    """Final pose and displacement of every body. Bodies with a goal also have the goal
    and the errors.
    """
    goals = {goal.body: goal.pose for goal in task.goals}
    true = true_task(task, runs[0].record.seed)
    first = start_state(true).with_body_at(OBJECT, task.true_start)
    out = {}
    for body, X in final_poses(runs[-1]).items():
        item: dict[str, Any] = {
            "final_pose": [X.x, X.y, wrap_angle(X.yaw)],
            "displacement": math.dist(X.position, first.poses[body].position),
        }
        if body in goals:
            goal = goals[body]
            position, yaw = _errors(X, goal)
            item["goal"] = [goal.x, goal.y, goal.yaw]
            item["position_error"] = position
            item["yaw_error"] = yaw
        out[body] = item
    return out


def _errors(X: Pose2, goal: Pose2) -> tuple[float, float]:
    return math.dist(X.position, goal.position), abs(wrap_angle(X.yaw - goal.yaw))


def _worst(task: Task, bodies: Mapping[str, Figures]) -> tuple[float, float]:
    """Largest position error [m] and yaw error [rad] of the bodies that have a goal."""
    aimed = [bodies[body] for body in dict.fromkeys(g.body for g in task.goals)]
    position = max(item["position_error"] for item in aimed)
    return position, max(item["yaw_error"] for item in aimed)


def _ending(
    task: Task,
    runs: Sequence[StageRun],
    results: Sequence[Figures],
    bodies: Mapping[str, Figures],
    *,
    truly: bool = False,
) -> Ending:
    """Ending of a run whose stages were all begun, unless one failed. ``truly`` says
    that true poses count, whatever the controller knows of them.
    """
    for number, (run, result) in enumerate(zip(runs, results, strict=True)):
        code = result["reason"]["code"]
        # where other bodies end counts at the end; one put aside may be anywhere
        judged_later = {"goal_reached", "body_moved"}
        reached = run.reached
        if run.stage.aside or truly:
            judged_later |= {"goal_missed", "not_verified"}
        if truly and not run.stage.aside:
            at_goal = is_within(run.plan.task, run.record)
            reached = finished(run.record) and at_goal
        if code not in judged_later or not reached:
            text = f"stage {number + 1}, {run.stage.body!r}: {result['reason']['text']}"
            return Ending(code, text)
    may_move = {obstacle.name for obstacle in task.obstacles if obstacle.may_move}
    place = "; ".join(_place(name, item) for name, item in bodies.items())
    for body, item in bodies.items():
        if "goal" in item and not _within(item, task):
            return Ending("goal_missed", f"{body!r} is not at its goal; {place}")
        allowed = task.tolerance.bodies
        stays = "goal" not in item and body not in may_move
        if stays and item["displacement"] > allowed:
            text = (
                f"{body!r} was moved by {item['displacement'] * 1e3:.1f} mm, "
                f"tolerance.bodies is {allowed * 1e3:g} mm"
            )
            return Ending("body_moved", text)
    return Ending("goal_reached", place)


def _within(figures: Figures, task: Task) -> bool:
    """Whether a body is at its goal, beside a bias of the camera."""
    x, y, yaw = figures["final_pose"]
    dx, dy = task.sensing.position_bias
    seen = Pose2(x + dx, y + dy, yaw + task.sensing.yaw_bias)
    return task.tolerance.holds(seen, Pose2(*figures["goal"]))


def _place(name: str, figures: Figures) -> str:
    if "goal" not in figures:
        return f"{name!r} was moved by {figures['displacement'] * 1e3:.1f} mm"
    return (
        f"{name!r} ended {figures['position_error'] * 1e3:.1f} mm and "
        f"{math.degrees(figures['yaw_error']):.2f} deg from its goal"
    )


def _planning_time(results: Sequence[Figures]) -> dict[str, float]:
    """Planning time [s] of all stages, by purpose."""
    out: dict[str, float] = {}
    for result in results:
        for name, time in (result["planning_time"] or {}).items():
            out[name] = out.get(name, 0.0) + time
    return out


def _events(
    runs: Sequence[StageRun], results: Sequence[Figures]
) -> list[dict[str, Any]]:
    return [
        {**event, "time": run.began + event["time"], "stage": number}
        for number, (run, result) in enumerate(zip(runs, results, strict=True))
        for event in result["events"]
    ]


def stage_figures(run: StageRun) -> dict[str, Any]:
    """Purpose and result of a started stage, as in result.json."""
    task = run.plan.task
    error = goal_error(task, run.record)
    aim = run.stage.goal if task.tool is None else task.tool.goal
    out = stage_to_do(run.stage)
    return out | {
        "body": run.stage.body if task.tool is None else task.tool.body,
        "goal": [aim.x, aim.y, aim.yaw],
        "modes": list(run.record.modes),
        "time": [run.began, run.began + run.duration],
        "reached": run.reached,
        "position_error": error.position,
        "yaw_error": error.yaw,
        "planned_anew": run.anew,
    }


def stage_to_do(stage: Stage) -> dict[str, Any]:
    """A stage that was not started, as in result.json."""
    return {
        "body": stage.body,
        "goal": [stage.goal.x, stage.goal.y, stage.goal.yaw],
        "aside": stage.aside,
        "modes": [],
        "time": None,
        "reached": False,
        "position_error": None,
        "yaw_error": None,
        "planned_anew": False,
        "figures": None,
    }
