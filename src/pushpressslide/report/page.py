"""Report of one or more runs as one HTML file without external resources."""

from __future__ import annotations

import base64
import math
import os
from collections.abc import Mapping, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import series, style
from pushpressslide.report.contest_part import contest_part
from pushpressslide.report.files import Run, load_run
from pushpressslide.report.filmstrip import filmstrip, motions
from pushpressslide.report.object_figure import planned_object
from pushpressslide.report.page_tables import (
    comparison_table,
    contacts_table,
    figures_tables,
    is_verified_success,
    mode_words,
    segments_table,
    table,
)
from pushpressslide.report.parameters import parameters_part
from pushpressslide.report.plane import plan_figure
from pushpressslide.report.plots import comparison_plot, figures
from pushpressslide.report.stage_tables import bodies_table, stages_table
from pushpressslide.report.stages import StagePlan
from pushpressslide.report.task_table import task_table
from pushpressslide.selection.planner import gathered

LINKS = {
    "replay.html": "Watch the replay",
    "run.mp4": "Video",
    "run.webp": "Video",
    "result.json": "result.json",
    "plan.json": "plan.json",
    "record.npz": "record.npz",
    "task.yaml": "task.yaml",
}
PICTURES = {
    "start": "At the start.",
    "contact": "Half-way, with the contact forces.",
    "end": "At the end.",
}
HINT = (
    '<script>for (const box of document.querySelectorAll(".scroll")) new ResizeObserver('
    '() => box.classList.toggle("wide", box.scrollWidth > box.clientWidth + 1)'
    ").observe(box);</script>"
)
"""Marks tables and plots wider than the window, so that a line says it."""
NARROW = 2  # contacts whose table fits a column
UNFOLDED = 8  # rows of the choice of a mode that a page shows at once
CAPTIONS = {
    "path": "What happened: footprints at even steps of the contact phase, with the force at each.",
    "errors": "Object against the reference at the same time, in the contact phase.",
    "tracking": "What the tracking law saw at its own tracking point.",
    "axle": "Where the object turned about, on the line from CoM to contact; and tracking errors.",
    "forces": "Contact force in the contact's axes. The band is what friction allows that normal force.",
    "torques": "Joint torques as a share of the maker's limits.",
    "speeds": "Speed of the tracking point and yaw rate of the object.",
}


def write_report(
    dirs: str | Path | Sequence[str | Path], out: str | Path | None = None
) -> Path:
    """Write the page of the run or runs in ``dirs`` and return its path.

    It also writes each run's plots/*.png. ``out`` is the HTML file: by default
    report.html in the run's folder, or for several runs in their common parent folder.
    The page for several runs starts with a comparison. Raises PushPressSlideError if a
    folder holds no finished run.
    """
    folders = [dirs] if isinstance(dirs, str | Path) else dirs
    if not folders:
        raise PushPressSlideError(
            "report: no folder given; give at least one that `pps run` has written"
        )
    runs = [load_run(folder) for folder in folders]
    single = len(runs) == 1
    if out is None:
        home = runs[0].folder
        if not single:
            home = Path(os.path.commonpath([run.folder.resolve() for run in runs]))
        out = home / "report.html"
    out = Path(out)
    if single:
        title = runs[0].task.name
        sections = [_run_section(runs[0], out, "")]
    else:
        title = f"{len(runs)} runs"
        names = _labels(runs)
        sections = [_comparison(runs, names)]
        for run, name in zip(runs, names, strict=True):
            sections.append(_run_section(run, out, name))
    body = f"<h1>{escape(title)}</h1>{''.join(sections)}"
    return write_whole(out, document(title, body))


def document(title: str, body: str) -> str:
    """A complete HTML page around ``body``, with the style embedded."""
    css = (
        resources.files("pushpressslide.report").joinpath("page.css").read_text("utf-8")
    )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)} - pushpressslide</title><style>{css}</style></head>\n"
        f"<body><main>{body}</main>{HINT}</body></html>\n"
    )


def image(data: bytes, alt: str, caption: str = "", kind: str = "png") -> str:
    """A picture as an HTML figure with the picture embedded. ``kind`` is the format of
    ``data``. A png, which has letters, scrolls sideways on a narrow page.
    """
    text = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    source = base64.b64encode(data).decode("ascii")
    shown = f'<img alt="{escape(alt)}" src="data:image/{kind};base64,{source}">'
    if kind == "png":
        shown = f'<div class="scroll">{shown}</div>'
    return f"<figure>{shown}{text}</figure>"


def _labels(runs: Sequence[Run]) -> list[str]:
    """Distinct short names of runs, made from the names of tasks or folders, or from
    numbers.
    """
    names = [run.task.name for run in runs]
    if len(set(names)) < len(runs):
        names = [run.folder.resolve().name for run in runs]
    if len(set(names)) < len(runs):
        names = [f"{i}: {name}" for i, name in enumerate(names, start=1)]
    return names


def _comparison(runs: Sequence[Run], names: Sequence[str]) -> str:
    curves = [
        (name, series.finite_part(run.record))
        for name, run in zip(names, runs, strict=True)
    ]
    return (
        "<section><h2>Side by side</h2>"
        + comparison_table(names, [run.result for run in runs])
        + image(style.png(comparison_plot(curves)), "errors of all runs over time")
        + "</section>"
    )


def _run_section(run: Run, page: Path, name: str) -> str:
    """Section of one run. Also writes the run's plots/*.png."""
    text = run.task.description
    single = not run.task.goals
    stages = [_stage_parts(run, number) for number in range(len(run.begun))]
    about = f"<h3>Task</h3>{task_table(run.task, run.result)}{command_line(run.result)}"
    parts = [
        f"<h2>{escape(name)}</h2>" if name else "",
        verdict(run.result),
        events(run.result),
        _warning(run.record),
        f"<p>{escape(text)}</p>" if text else "",
        f'<p class="links">{links(run.folder, page)}</p>',
        pictures(run.folder),
    ]
    if single:
        plan, details, figures_part, plots = stages[0]
        parts += [columns(about, plan), details, figures_part, plots]
        return f"<section>{''.join(parts)}</section>"
    parts += [
        "<h3>Bodies</h3>",
        bodies_table(run.result),
        "<h3>Stages</h3>",
        stages_table(run.result),
        about,
        "<h3>Figures</h3>",
        columns(*figures_tables(run.result)),
    ]
    sections = [f"<section>{''.join(parts)}</section>"]
    for number, (stage, made) in enumerate(zip(run.begun, stages, strict=True), 1):
        purpose = "put aside" if stage.stage.aside else "to its goal"
        title = f"Stage {number}: {stage.stage.body}, {purpose}"
        body = "".join(made)
        sections.append(f"<section><h2>{escape(title)}</h2>{body}</section>")
    return "".join(sections)


def _stage_parts(run: Run, number: int) -> tuple[str, str, str, str]:
    """Picture of a stage's plan, the reason for the mode, the figures and the plots.

    Also writes the plots.
    """
    stage = run.begun[number]
    plan = image(
        style.png(plan_figure(stage.plan)),
        "plan",
        "The plan, made before anything moves.",
    )
    result = run.result["stages"][number]["figures"] or run.result
    details = [
        _mode_part(stage),
        _object_part(stage.plan),
        search_part(result.get("search")),
        _filmstrip(stage.plan),
        _segments_part(stage.plan),
    ]
    which = f"stage-{number + 1}-" if run.task.goals else ""
    plots = []
    for key, made in figures(stage.plan, series.finite_part(stage.record)).items():
        png = style.png(made)
        write_whole(run.folder / "plots" / f"{which}{key}.png", png)
        plots.append(image(png, key, _caption(key)))
    measured = f"<h3>Figures</h3>{_figures_part(stage.plan, result)}"
    measured += parameters_part(result)
    return plan, "".join(details), measured, f"<h3>Plots</h3>{columns(*plots)}"


def _segments_part(plan: Plan) -> str:
    """Segments of a plan. Empty for a plan with a single segment."""
    segments = segments_table(plan)
    return f"<h3>Segments</h3>{segments}" if segments else ""


def _object_part(plan: Plan) -> str:
    """Picture of an object from a mesh. Empty for any other object."""
    figure = planned_object(plan)
    if figure is None:
        return ""
    caption = "What stands on the support, and where tips can push and press."
    return f"<h3>Object</h3>{image(style.png(figure), 'object', caption)}"


def _figures_part(plan: Plan, result: Mapping[str, Any]) -> str:
    """Tables of figures and of contacts. The contacts are placed in the shorter column
    if they fit.
    """
    first, second = figures_tables(result)
    contacts = f"<h3>Contacts</h3>{contacts_table(plan, result)}"
    count = sum(len(placement.contacts) for placement in plan.by_placement)
    if count <= NARROW:
        return columns(first, second + contacts)
    return columns(first, second) + contacts


def columns(*parts: str) -> str:
    """Parts placed side by side if the page is wide enough."""
    cells = "".join(f"<div>{part}</div>" for part in parts if part)
    return f'<div class="columns">{cells}</div>'


def pictures(folder: Path) -> str:
    """The existing pictures of the scene at start, contact and end."""
    made = []
    for name, words in PICTURES.items():
        path = folder / "pictures" / f"{name}.webp"
        if path.is_file():
            made.append(image(path.read_bytes(), name, words, "webp"))
    return f'<div class="pictures">{"".join(made)}</div>' if made else ""


def command_line(result: Mapping[str, Any]) -> str:
    """Command that made a run, or that repeats it, with the versions."""
    command = result.get("command")
    words = "Made by"
    if not command:
        words = "Run again, in this folder, by"
        engine = result["engine"]
        command = f"pps run task.yaml --engine {engine} --seed {result['seed']}"
    versions = ", ".join(f"{name} {v}" for name, v in result["versions"].items())
    return (
        f"<p class=again>{words} <code>{escape(command)}</code><br>"
        f"with {escape(versions)}</p>"
    )


def _filmstrip(plan: Plan) -> str:
    """Filmstrip of a plan of several motions."""
    if len(motions(plan)) < 2:
        return ""
    caption = (
        "Its motions one by one: from black to green, with the contacts at the start."
    )
    return image(style.png(filmstrip(plan)), "motions", caption)


def events(result: Mapping[str, Any]) -> str:
    """Events of a run, with the recovery from each."""
    rows = []
    for event in result["events"]:
        what = f"<code>{escape(event['code'])}</code> {escape(event['text'])}"
        onward = "The arms let go, and the rest was replanned."
        if not event["recovered"]:
            onward = f"No other attempt: {escape(event['lacking'])}."
        rows.append(f"<li>{event['time']:.1f} s: {what}. {onward}</li>")
    return f"<ul>{''.join(rows)}</ul>" if rows else ""


def verdict(result: Mapping[str, Any]) -> str:
    """Whether a run reached its goal, as is true and as the controller knows, and the
    reason for its end.
    """
    css = "good" if is_verified_success(result) else "bad"
    words = _verdict_words(result["success"], result.get("verified", True))
    reason = result["reason"]
    return (
        f'<p class="verdict {css}"><strong>{words}</strong> '
        f"<code>{escape(str(reason['code']))}</code> {escape(str(reason['text']))}</p>"
    )


def _verdict_words(success: bool | None, verified: bool) -> str:
    if success is None:
        return "Goal reached, as measured" if verified else "Goal not verified"
    if not success:
        return "Goal missed"
    return "Goal reached" if verified else "Goal reached, but not verified"


def _warning(record: Record) -> str:
    """Warning that states from what time on the record contains NaN or infinity. Empty
    if it contains neither.
    """
    count = series.finite_ticks(record)
    if count == series.ticks(record):
        return ""
    when = "from the start"
    if count:
        when = f"after {record.arrays['time'][count - 1]:.3f} s"
    return (
        f"<p><strong>The state is not a number {when}.</strong> Plots and replay end "
        "there; figures that need the rest are missing.</p>"
    )


def links(folder: Path, page: Path) -> str:
    """Links to the existing files of a run."""
    return " ".join(
        f'<a class="button" href="{escape(_link(folder / file, page))}">{label}</a>'
        for file, label in LINKS.items()
        if (folder / file).is_file()
    )


def _caption(key: str) -> str:
    """Caption of a figure. For a figure of one placement it ends with the placement's
    number.
    """
    name, _, placement = key.partition("-")
    caption = CAPTIONS[name]
    if not placement:
        return caption
    return f"Placement {placement}. {caption}"


def _link(target: Path, page: Path) -> str:
    return Path(os.path.relpath(target.resolve(), page.resolve().parent)).as_posix()


def _mode_part(stage: StagePlan) -> str:
    """Reason for the mode, its rivals, and all choices. Empty if no choices are stored."""
    reason = contest_part(stage.plan, stage.choices)
    choices = _choice_part(stage, folded=bool(reason))
    if not reason and not choices:
        return ""
    return f"<h3>Why this mode</h3>{reason}{choices}"


def _choice_part(stage: StagePlan, folded: bool) -> str:
    """Table of all choices considered, with their reasons. Empty if no choices are
    stored.

    A ``folded`` or long table opens on a click.
    """
    if not stage.choices:
        return ""
    taken = stage.plan.chosen(stage.choices)
    rows = []
    marks = []
    for choice, reason in gathered(stage.choices):
        verdict = choice.verdict
        mark = ""
        if choice in taken:
            verdict = "chosen"
            mark = ' class="chosen"'
        elif not choice.feasible:
            mark = ' class="refused"'
        rows.append(
            [
                f"<td>{escape(verdict)}</td>",
                f"<td>{mode_words(choice.mode)}</td>",
                _number_cell(choice.path_length, 1.0, " m", 3),
                _number_cell(choice.time, 1.0, " s", 1),
                _number_cell(choice.friction_margin, math.degrees(1.0), "°", 1),
                f"<td class=why>{escape(reason)}</td>",
            ]
        )
        marks.append(mark)
    head = ("", "Mode", "Path", "Time", "Friction margin", "Why")
    shown = table(head, rows, marks)
    if folded or len(rows) > UNFOLDED:
        text = f"All {len(rows)} contacts and modes that were weighed"
        shown = f"<details><summary>{text}</summary>{shown}</details>"
    return shown


def search_part(search: Mapping[str, Any] | None) -> str:
    """Motions tried by a search over several motions, and why each was dropped. Empty
    without a search.
    """
    if search is None:
        return ""
    rows = []
    for refused in search["refused"]:
        count = f"{refused['count']} motions"
        rows.append(_dropped(refused["mode"], count, refused["text"]))
    for sequence in search["dropped"]:
        modes = ", ".join(sequence["modes"])
        time = f"one sequence, {sequence['time']:.1f} s"
        rows.append(_dropped(modes, time, sequence["why"]))
    text = (
        f"No single motion was found. {search['judged']} motions between start, goal and "
        f"{search['poses']} poses in between were evaluated."
    )
    dropped = table(("Modes", "Dropped", "Why"), rows) if rows else ""
    return f"<h3>Search for several motions</h3><p>{escape(text)}</p>{dropped}"


def _dropped(modes: str, what: str, why: str) -> list[str]:
    """Table cells of one dropped mode or sequence."""
    return [
        f"<td>{escape(modes)}</td>",
        f"<td>{escape(what)}</td>",
        f"<td class=why>{escape(why)}</td>",
    ]


def _number_cell(value: float | None, factor: float, unit: str, decimals: int) -> str:
    text = ""
    if value is not None:
        text = f"{factor * value:.{decimals}f}{unit}"
    return f"<td class=n>{text}</td>"
