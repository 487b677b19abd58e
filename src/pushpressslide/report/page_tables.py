"""HTML tables of the figures of one run, or of several runs side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.scene import arm_title

NO_BREAK = "\N{NO-BREAK SPACE}"  # between a number and its unit


@dataclass(frozen=True, slots=True)
class Row:
    """A figure of result.json, as a row of a table."""

    label: str
    key: str  # in result.json; dots go down
    factor: float  # from SI to ``unit``
    unit: str
    decimals: int
    note: str = ""  # said under the label of a value above zero

    def text(self, result: Mapping[str, Any], key: str = "") -> str:
        """Figure with its unit, or a dash if it does not apply.

        ``key`` names another figure of the same kind.
        """
        value = lookup(result, key or self.key)
        if value is None:
            return "–"
        space = "" if self.unit == "°" else " "
        return f"{self.factor * value:.{self.decimals}f}{space}{self.unit}"

    def cell(self, result: Mapping[str, Any]) -> str:
        """Figure as a table cell, marked if it has a tolerance."""
        return f'<td class="n {_tolerance_class(result, self.key)}">{self.text(result)}</td>'


LATE = (
    "Of the wall clock, which a simulation does not follow: they do not change the "
    "result. On a robot these commands would come late."
)
BIAS = "Success is judged by these: nothing can see a constant bias."
Groups = tuple[tuple[str, tuple[Row, ...]], ...]
"""Groups of rows, each with its heading."""

GROUPS: Groups = (
    (
        "At the goal",
        (
            Row("Position error", "final_position_error", 1e3, "mm", 2),
            Row("Yaw error", "final_yaw_error", 180.0 / math.pi, "°", 2),
            Row(
                "Position error, camera's bias subtracted",
                "error_beside_bias.position",
                1e3,
                "mm",
                2,
                BIAS,
            ),
            Row(
                "Yaw error, camera's bias subtracted",
                "error_beside_bias.yaw",
                180.0 / math.pi,
                "°",
                2,
            ),
        ),
    ),
    (
        "During the run, against the first plan at the same time",
        (
            Row("Position error, RMS", "rms_position_error", 1e3, "mm", 2),
            Row("Yaw error, RMS", "rms_yaw_error", 180.0 / math.pi, "°", 2),
            Row("End-effector error, RMS", "rms_end_effector_error", 1e3, "mm", 2),
            Row("Position error, largest", "max_position_error", 1e3, "mm", 2),
        ),
    ),
    (
        "Against the path",
        (
            Row("Tracking point to the path, RMS", "path_rms_error", 1e3, "mm", 2),
            Row("Way of the tracking point", "path_length", 1.0, "m", 3),
        ),
    ),
    (
        "Contact",
        (
            Row("Largest normal force", "max_normal_force", 1.0, "N", 1),
            Row("Its largest mean over 20 ms", "max_mean_normal_force", 1.0, "N", 1),
            Row("The same without stops", "max_force_without_stop", 1.0, "N", 1),
            Row("Contact lost for", "contact_loss_time", 1e3, "ms", 0),
            Row(
                "Outside the friction cone",
                "cone_violation_fraction",
                100.0,
                "% of ticks",
                2,
            ),
            Row(
                "Commanded outside the friction cone",
                "cone_use_commanded.share",
                100.0,
                "% of ticks",
                2,
            ),
            Row("Slip along the surface", "slip_distance", 1e3, "mm", 2),
            Row("Largest tilt of the object", "max_tilt_deg", 1.0, "°", 2),
            Row("Farthest off the support", "support_gap_max", 1e3, "mm", 2),
            Row("Falls while entering", "fall_height", 1e3, "mm", 1),
            Row("Falls as fast as", "fall_speed", 1.0, "m/s", 2),
            Row("Depth in the opening", "seated_depth", 1e3, "mm", 1),
        ),
    ),
    (
        "Arms",
        (
            Row(
                "Share of the torque limit, largest", "max_torque_share", 100.0, "%", 0
            ),
            Row(
                "Share of the speed limit, largest",
                "max_joint_speed_share",
                100.0,
                "%",
                0,
            ),
            Row(
                "Asked for more than a torque limit",
                "torque_limit_violation_fraction",
                100.0,
                "% of ticks",
                2,
            ),
            Row(
                "Asked for a faster torque than allowed",
                "torque_rate_saturated_fraction",
                100.0,
                "% of ticks",
                2,
            ),
            Row("Clearance as driven", "clearance_driven", 1e3, "mm", 1),
            Row(
                "Least distance to a joint limit",
                "joint_limit_margin",
                180.0 / math.pi,
                "°",
                1,
            ),
        ),
    ),
    (
        "Time",
        (
            Row("Duration, simulated", "duration", 1.0, "s", 2),
            Row("Contact phase", "motion_duration", 1.0, "s", 2),
            Row("Simulated over wall time", "realtime_factor", 1.0, "×", 2),
            Row("Track, median a tick", "tick_us.track.median", 1e-3, "ms", 3),
            Row("Allocate, median a tick", "tick_us.allocate.median", 1e-3, "ms", 3),
            Row("Execute, median a tick", "tick_us.execute.median", 1e-3, "ms", 3),
            Row("All of a tick, median", "tick_us.total.median", 1e-3, "ms", 3),
            Row("All of a tick, 99th percentile", "tick_us.total.p99", 1e-3, "ms", 3),
            Row(
                "All of a tick, 99.9th percentile",
                "tick_us.total.p999",
                1e-3,
                "ms",
                3,
            ),
            Row("Ticks longer than the period", "late_ticks", 1.0, "", 0, LATE),
        ),
    ),
)

SPLIT = 4
"""Number of groups in the first of two adjacent tables."""

CONTACT_ROWS: tuple[Row, ...] = (
    Row("Planned load", "load", 1.0, "N", 1),
    Row("Normal, mean", "mean_normal_force", 1.0, "N", 1),
    Row("Normal, largest", "max_normal_force", 1.0, "N", 1),
    Row("Friction used, mean", "mean_friction_use", 100.0, "%", 0),
    Row("Outside the cone", "cone_violation_fraction", 100.0, "%", 2),
    Row("Lost for", "contact_loss_time", 1e3, "ms", 0),
    Row("Slip", "slip_distance", 1e3, "mm", 2),
)
KINDS = {"side": "push on a side", "top": "press on top"}

PERIOD = "control_period"  # [s]
ASKED = {
    "final_position_error": "tolerance.position",
    "final_yaw_error": "tolerance.yaw",
    "error_beside_bias.position": "tolerance.position",
    "error_beside_bias.yaw": "tolerance.yaw",
    "motion_duration": "planned.motion_duration",
    "path_length": "planned.path_length",
    "joint_limit_margin": "planned.joint_limit_margin",
    "clearance_driven": "planned.clearance",
    "tick_us.total.median": PERIOD,
    "tick_us.total.p99": PERIOD,
    "tick_us.total.p999": PERIOD,
}
"""Key of each figure's reference: a tolerance, the plan's prediction, or the control
period.
"""


def is_verified_success(result: Mapping[str, Any]) -> bool:
    """Whether a run reached its goal, as far as is true, and the controller knows it."""
    return result["success"] is not False and result.get("verified", True)


def lookup(result: Mapping[str, Any], key: str) -> Any:
    """Value at a dotted key. None if any step is missing or null."""
    value: Any = result
    for step in key.split("."):
        value = value.get(step) if isinstance(value, Mapping) else None
    return value


def table(
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    attributes: Sequence[str] = (),
    numbers: int = 0,
) -> str:
    """An HTML table that scrolls sideways if it is too wide.

    ``rows`` contain finished cells, ``attributes`` the attributes of each row's tag.
    The last ``numbers`` columns are right-aligned.
    """
    words = len(head) - numbers
    cells = [f'<th scope="col">{escape(text)}</th>' for text in head[:words]]
    cells += [f'<th scope="col" class=n>{escape(text)}</th>' for text in head[words:]]
    top = f"<thead><tr>{''.join(cells)}</tr></thead>" if head else ""
    marks = attributes or [""] * len(rows)
    lines = "".join(
        f"<tr{mark}>{''.join(row)}</tr>" for mark, row in zip(marks, rows, strict=True)
    )
    return f'<div class="scroll"><table>{top}<tbody>{lines}</tbody></table></div>'


def mode_words(mode: str) -> str:
    """A mode's name with line breaks allowed at its underscores, for narrow columns."""
    return escape(mode).replace("_", "_<wbr>")


def number_cells(texts: Iterable[str]) -> list[str]:
    """Right-aligned table cells."""
    return [f'<td class="n">{escape(text)}</td>' for text in texts]


def group_row(text: str, columns: int) -> list[str]:
    """The only cell, over ``columns`` columns, of a row that heads a group."""
    return [f'<th colspan="{columns}" scope="rowgroup">{escape(text)}</th>']


def figures_table(result: Mapping[str, Any]) -> str:
    """Figures of one run: measured values next to the requested or planned values."""
    return _figures(result, GROUPS)


def figures_tables(result: Mapping[str, Any]) -> tuple[str, str]:
    """Figures of one run in two tables, for two columns of a page."""
    return _figures(result, GROUPS[:SPLIT]), _figures(result, GROUPS[SPLIT:])


def _figures(result: Mapping[str, Any], groups: Groups) -> str:
    rows, marks = _grouped_rows(
        [result],
        lambda row: [row.cell(result), f'<td class="n">{_asked(result, row)}</td>'],
        groups,
    )
    if not rows:
        return ""
    return table(("", "Measured", "Asked or planned"), rows, marks, numbers=2)


def comparison_table(names: Sequence[str], results: Sequence[Mapping[str, Any]]) -> str:
    """Figures of several runs, one column each."""
    engines = number_cells(str(result["engine"]) for result in results)
    modes = number_cells(", ".join(result["modes"]) for result in results)
    head = [
        ['<th scope="row">Engine</th>', *engines],
        ['<th scope="row">Mode</th>', *modes],
        ['<th scope="row">Outcome</th>', *map(_outcome_cell, results)],
    ]
    rows, marks = _grouped_rows(
        results, lambda row: [row.cell(result) for result in results]
    )
    marks = [""] * len(head) + marks
    return table(("", *names), [*head, *rows], marks, numbers=len(names))


def _outcome_cell(result: Mapping[str, Any]) -> str:
    css = "ok" if is_verified_success(result) else "no"
    outcome = escape(result["reason"]["code"].replace("_", " "))
    return f'<td class="n {css}">{outcome}</td>'


def _grouped_rows(
    results: Sequence[Mapping[str, Any]],
    cells: Callable[[Row], list[str]],
    groups: Groups = GROUPS,
) -> tuple[list[list[str]], list[str]]:
    """Rows, with their attributes, for every figure that at least one of ``results``
    has.
    """
    rows: list[list[str]] = []
    marks: list[str] = []
    for group, entries in groups:
        lines = [
            [f'<th scope="row">{_label(row, results)}</th>', *cells(row)]
            for row in entries
            if any(lookup(result, row.key) is not None for result in results)
        ]
        if lines:
            rows += [group_row(group, len(lines[0])), *lines]
            marks += [' class="group"', *[""] * len(lines)]
    return rows, marks


def _label(row: Row, results: Sequence[Mapping[str, Any]]) -> str:
    """Label of a figure, with its note if it needs one."""
    label = escape(row.label)
    if row.note and any(lookup(result, row.key) for result in results):
        label += f"<br><span class=why>{escape(row.note)}</span>"
    return label


def _asked(result: Mapping[str, Any], row: Row) -> str:
    """Requested or planned value of a figure. Empty if the figure has no such value."""
    key = ASKED.get(row.key, "")
    if lookup(result, key) is None:
        return ""
    if key == PERIOD:
        return f"period {1e3 * result[PERIOD]:g} ms"
    sign = "≤ " if key.startswith("tolerance") else ""
    return sign + row.text(result, key)


def _tolerance_class(result: Mapping[str, Any], key: str) -> str:
    """CSS class of a figure with a tolerance, which says whether it is met."""
    limit = ASKED.get(key, "")
    value = lookup(result, key)
    allowed = lookup(result, limit)
    biased = result.get("error_beside_bias") is not None
    if biased and key.startswith("final_"):
        return ""
    if not limit.startswith("tolerance") or allowed is None or value is None:
        return ""
    return "ok" if value <= allowed else "no"


def contacts_table(plan: Plan, result: Mapping[str, Any]) -> str:
    """Position, load and measured figures of each contact, one column each."""
    plans = plan.by_placement if result["contacts"] else (plan,)
    names = _contact_names(plan, plans)
    contacts = [contact for part in plans for contact in part.contacts]
    measured = [*(result["contacts"] or ())]
    measured += [{}] * (len(contacts) - len(measured))
    lines = [
        ("Contact", [KINDS[c.kind] for c in contacts]),
        (
            "Place, from the CoM",
            [f"({1e3 * c.point[0]:.0f}, {1e3 * c.point[1]:.0f}) mm" for c in contacts],
        ),
        ("Height", [f"{1e3 * c.height:.0f} mm" for c in contacts]),
    ]
    lines += [
        (row.label, [row.text(figures) for figures in measured]) for row in CONTACT_ROWS
    ]
    rows = [
        [f'<th scope="row">{label}</th>', *number_cells(cells)]
        for label, cells in lines
    ]
    return table(("", *names), rows, numbers=len(names))


def _contact_names(plan: Plan, parts: Sequence[Plan]) -> list[str]:
    """Names of the contacts of ``parts``, by placement, arm and robot."""
    robots = plan.task.robots
    placements = plan.by_placement
    names = []
    for part in parts:
        which = ""
        if len(placements) > 1:
            which = f"placement {placements.index(part) + 1}, "
        for contact in part.contacts:
            model = Path(robots[contact.arm].model).name
            title = arm_title(contact.arm, len(robots))
            names.append(f"{which}{title}: {model}".capitalize())
    return names


def segments_table(plan: Plan) -> str:
    """Table of a plan's segments. Empty for a plan of one segment."""
    if len(plan.segments) < 2:
        return ""
    rows = []
    for i, segment in enumerate(plan.segments):
        goal = segment.goal
        axle = segment.X_BV
        cells = (
            f"{segment.path.distance:.3f}{NO_BREAK}m",
            f"{segment.profile.duration:.1f}{NO_BREAK}s",
            f"({1e3 * axle.x:.0f}, {1e3 * axle.y:.0f}) mm, "
            f"{math.degrees(wrap_angle(axle.yaw)):.1f}°",
            f"({goal.x:.3f}, {goal.y:.3f}) m, "
            f"{math.degrees(wrap_angle(goal.yaw)):.1f}°",
        )
        rows.append([f'<th scope="row">{i + 1}</th>', *number_cells(cells)])
    return table(
        ("Segment", "Path", "Time", "Tracking point, from the CoM", "Leads to"),
        rows,
        numbers=4,
    )
