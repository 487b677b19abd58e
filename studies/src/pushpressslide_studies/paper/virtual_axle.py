"""Virtual axle of a pressed object: measured in Drake, predicted, and as in the paper.

The box of the task ``press-slide`` is pressed with several loads at two heights and
dragged in many directions, open loop. Source: docs/mechanics.md, sections 4 and 4.1;
studies/docs/virtual-axle.md.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.task import Box, Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.parallel import Progress, in_parallel
from pushpressslide.mechanics.press_axle import PAPER_C, Press
from pushpressslide.mechanics.pressing import friction_use
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight
from pushpressslide.report.metrics import installed_versions
from pushpressslide.taskfile.load import load_task

if TYPE_CHECKING:
    from pushpressslide_studies.sim.axle_probe import Probe

SCHEMA = 1
TASK = "press-slide"
TOLERANCE = 0.010  # [m] within which measured and predicted are to agree
# [deg] of the force from CoM to contact
ANGLES = (5, 15, 30, 45, 60, 75, 90, 105, 120, 135, 150, 165, 175)
LOADS = (4.0, 8.0, 16.0)  # [N]
HEIGHTS = (0.05, 0.10)  # [m] of the object, and so of the contact on top of it
CURVE = range(2, 179, 4)  # [deg] where the predicted lines are computed
# of the tip's friction, above which the contact is not expected to stick
MOST_USE = 0.95

CHECKED = ((5, 8.0, 0.10), (75, 8.0, 0.10), (175, 16.0, 0.10))
"""Probes that are repeated with one field changed: a straight motion, a turn about a
point under the object, and the farthest axle.
"""
VARIANTS: Mapping[str, tuple[Mapping[str, Any], float]] = {
    "six cells across": ({"cells": 6.0}, 0.004),
    "three cells across": ({"cells": 3.0}, 0.004),
    "half the speed": ({"speed": 0.025}, 0.004),
    "time step of 2 ms": ({}, 0.002),
    "hand's yaw held": ({"hold_yaw": True}, 0.004),
}
"""Changes in repeated probes: fields of the probe, and the time step [s]."""
DIRECTIONS = {-1: "forward", 0: "across", 1: "backward"}
"""Direction of the force, by the sign of its angle from the line to the contact minus
90 deg.
"""


@dataclass(frozen=True, slots=True)
class Case:
    """One probe of the table, or a repetition of it with a change."""

    angle: float  # [deg]
    load: float  # [N]
    height: float  # [m]
    variant: str = ""


LIGHT = tuple(
    Case(angle, 8.0, height) for height in HEIGHTS for angle in (5, 45, 90, 135, 175)
)
"""Probes under the paper's press, in a few directions."""


def virtual_axle(
    out: Path, jobs: int = 0, quick: bool = False, progress: Progress | None = None
) -> dict[str, Any]:
    """Run the probes and return the result.

    It writes result.json, table.md, axles.png and report.html to ``out``. ``jobs`` is
    the number of processes, 0 for one per core. With ``quick`` there are only ten
    probes. If the contact is predicted to slip or the object to tip, the probe is not
    run and its row says so.
    """
    from pushpressslide_studies.paper.axle_page import write_virtual_axle

    task = load_task(TASK)
    table = [
        Case(angle, load, height)
        for height in HEIGHTS
        for load in LOADS
        for angle in ANGLES
    ]
    checks = [Case(*case, variant) for variant in VARIANTS for case in CHECKED]
    cases = LIGHT if quick else [*table, *checks]
    rows = in_parallel(work_of(task, cases), jobs or os.cpu_count() or 1, progress)
    result = result_of(task, list(rows.values()))
    write_whole(out / "result.json", json.dumps(result, indent=1) + "\n")
    write_virtual_axle(result, out)
    return result


def work_of(
    task: Task, cases: Sequence[Case]
) -> dict[Case, Callable[[], dict[str, Any]]]:
    """Functions that measure each case, by case."""
    return {case: partial(run_case, task, case) for case in cases}


def result_of(task: Task, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Contents of result.json, from the rows of ``run_case``."""
    table = [row for row in rows if not row["variant"]]
    settings = sorted({(row["height"], row["load"]) for row in table})
    return {
        "schema": SCHEMA,
        "task": TASK,
        "tolerance": TOLERANCE,
        "support_friction": task.support.friction,
        "contact_friction": task.contact_friction,
        "rows": table,
        "checks": [row for row in rows if row["variant"]],
        "curves": [_curve(pressed(task, load, height)) for height, load in settings],
        "paper_figures": paper_figures(task),
        "summary": summarise(table),
        "versions": installed_versions(),
    }


def pressed(task: Task, load: float, height: float) -> Press:
    """The task's box under a press of ``load`` [N] at the task's point.

    The box has the height ``height`` [m].
    """
    shape = task.object.shape
    places = task.motion.contacts
    com = task.object.center_of_mass
    assert isinstance(shape, Box)
    assert places is not None
    body = replace(task.object, shape=Box((shape.size[0], shape.size[1], height)))
    contact = (places[0][0] - com[0], places[0][1] - com[1])
    return Press(body, task.support.friction, contact, load)


def predict(task: Task, case: Case) -> dict[str, Any]:
    """Expected axles [m] of a case, relative to the CoM.

    ``skipped`` is the reason why the case cannot be measured. It is empty if it can.
    """
    press = pressed(task, case.load, case.height)
    angle = math.radians(case.angle)
    row = {
        **asdict(case),
        "direction": DIRECTIONS[(case.angle > 90.0) - (case.angle < 90.0)],
        "predicted": None,
        "without_height": None,
        "paper": press.paper_axle(),
        "skipped": "",
    }
    try:
        row |= {
            "predicted": press.axle(angle),
            "without_height": press.axle(angle, 0.0),
        }
    except ValueError as error:
        return {**row, "skipped": f"tips: {error}"}
    utilisation = friction_use(
        case.load, press.weight, task.support.friction, task.contact_friction
    )
    if utilisation > MOST_USE:
        row["skipped"] = (
            f"slips: takes {utilisation:.2f} of the tip's friction, at most "
            f"{MOST_USE:g}"
        )
    return row


def run_case(task: Task, case: Case) -> dict[str, Any]:
    """Result of one case: its predictions, and the measurement of its run."""
    from pushpressslide_studies.sim.axle_probe import Probe, probe_axle

    row = predict(task, case)
    if row["skipped"]:
        return {**row, "measured": None}
    press = pressed(task, case.load, case.height)
    changes, time_step = VARIANTS.get(case.variant, ({}, 0.004))
    probe: Probe = Probe(press.contact, case.load, math.radians(case.angle), **changes)
    try:
        measured = probe_axle(replace(task, object=press.body), probe, time_step)
    except SimulationError as error:
        return {**row, "measured": None, "skipped": str(error)}
    figures = asdict(measured)
    return {
        **row,
        "measured": figures.pop("axle"),
        **{f"measured_{key}": v for key, v in figures.items()},
    }


def summarise(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Counts, and the median and largest error [m] of each formula."""
    measured = [row for row in rows if row["measured"] is not None]

    def spread(key: str) -> dict[str, float] | None:
        """Median and largest error [m] of a formula."""
        errors = sorted(abs(row["measured"] - row[key]) for row in measured)
        if not errors:
            return None
        return {"median": errors[len(errors) // 2], "max": errors[-1]}

    return {
        "probes": len(rows),
        "measured": len(measured),
        "within_tolerance": sum(
            abs(row["measured"] - row["predicted"]) <= TOLERANCE for row in measured
        ),
        **{key: spread(key) for key in ("predicted", "without_height", "paper")},
    }


def _curve(press: Press) -> dict[str, Any]:
    """Predictions over the angle of the force, for one load and height."""
    angles = [math.radians(a) for a in CURVE]
    return {
        "height": press.body.shape.height,
        "load": press.load,
        "angle": list(CURVE),
        "predicted": [_unless_tipped(press, a, None) for a in angles],
        "without_height": [_unless_tipped(press, a, 0.0) for a in angles],
        "cop": math.hypot(*press.cop),
        "lever": press.lever,
        "paper": press.paper_axle(),
        "paper_from_cop": press.paper_distance(),
        "paper_printed": press.paper_printed(),
    }


def _unless_tipped(press: Press, angle: float, height: float | None) -> float | None:
    try:
        return press.axle(angle, height)
    except ValueError:
        return None


@dataclass(frozen=True, slots=True)
class PaperAxleFigure:
    """A figure of the paper's experiment. Missing values are None."""

    what: str
    paper: float | None  # as printed
    recomputed: float | None  # by the paper's own formulas
    exact: float | None  # by the exact model
    unit: str = "m"
    note: str = ""


def paper_figures(task: Task) -> list[dict[str, Any]]:
    """The paper's figures of this experiment as fields of ``PaperAxleFigure``.

    Positions of axles, relative to the CoM, are positive towards the contact, which
    makes the paper's distance negative. The paper states neither friction nor height
    for these figures; here they are those of the task.
    """
    press = pressed(task, 8.0, task.object.shape.height)
    body = press.body
    pressure = support_pressure(body.shape, 1.0, body.center_of_mass, press.cop, 20)
    straight = rho_straight(pressure)
    figures = (
        *_figures_of_constant(press, straight),
        *_figures_of_seen_axle(press, straight, rho_pole(pressure)),
        *_figures_at_height(press),
    )
    return [asdict(figure) for figure in figures]


def _figures_of_constant(press: Press, straight: float) -> Iterator[PaperAxleFigure]:
    """Yield lever and axle from the paper's c. ``straight`` is rho [m] of straight
    motion.
    """
    f = PaperAxleFigure
    cop = math.hypot(*press.cop)
    lever = press.lever
    variance = straight**2
    end_lifts = "past a sixth of the length: an end lifts"
    yield f("centre of pressure from the CoM", None, cop, cop, note=end_lifts)
    yield f("lever d, centre of pressure to contact", 0.054, lever, lever)
    paper = (PAPER_C * press.half_diagonal) ** 2
    reason = "the pressure's variance"
    yield f("(c r0)^2 with c = 0.6", 0.036, paper, variance, "m²", reason)
    distance = press.paper_distance()
    yield f("axle to centre of pressure, c = 0.6", 0.67, distance, variance / lever)
    added = (
        "printed as a distance, 0.82 m: the way from CoM to centre of pressure is "
        "added, not taken off"
    )
    axle = press.paper_axle()
    exact = press.axle(0.0, 0.0)
    yield f("axle from the CoM, c = 0.6", -0.82, axle, exact, note=added)


def _figures_of_seen_axle(
    press: Press, straight: float, pole: float
) -> Iterator[PaperAxleFigure]:
    """Yield the axle in the paper's simulation, and the c that it requires.

    ``straight`` and ``pole`` are rho [m] of straight motion and of turning on the spot.
    """
    f = PaperAxleFigure
    seen = 0.346  # [m] from the CoP, in the paper's simulation
    r0 = press.half_diagonal
    c = math.sqrt(seen * press.lever) / r0
    note = f"exact: near straight motion; {pole / r0:.3f} for turning on the spot"
    yield f("c for the axle that the paper saw", 0.43, c, straight / r0, "", note)
    axle = math.hypot(*press.cop) - seen
    note = f"the paper's {seen} m from the centre of pressure"
    yield f("axle that the paper saw, from the CoM", -0.2, axle, None, note=note)


def _figures_at_height(press: Press) -> Iterator[PaperAxleFigure]:
    """Yield the axle of an object dragged at the height of its top, a case that the
    paper does not treat.
    """
    what = "the same, {}, drag at the top's height"
    yield PaperAxleFigure(what.format("pushed"), None, None, press.axle(math.pi))
    pulled = press.axle(0.0)
    note = "ahead of the CoM"
    yield PaperAxleFigure(what.format("pulled"), None, None, pulled, note=note)
