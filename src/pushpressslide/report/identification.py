"""Page of identified supports.

It has tables, and for each set a figure of predictions, limit surface and support.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.whole_file import write_whole
from pushpressslide.identification.identified_set import IdentifiedSet
from pushpressslide.identification.intervals import METHOD
from pushpressslide.identification.next_push import MORE
from pushpressslide.identification.recorded_sets import RecordedSet
from pushpressslide.identification.scoring import Identification
from pushpressslide.mechanics.rho import rho_pole
from pushpressslide.report import style
from pushpressslide.report.page import document, image
from pushpressslide.report.page_tables import number_cells, table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


MODELS = {
    "ellipsoid": ("ellipsoid, rho alone", style.ORANGE, "-"),
    "full_ellipsoid": ("ellipsoid, full", style.AMBER, "--"),
    "quartic": ("convex quartic", style.PURPLE, "-"),
    "pressure": ("fitted pressure", style.BLUE, "-"),
    "no_fit": ("no fit", style.GREEN, "--"),
    "no_fit_uniform": ("no fit, even load", style.GREY, ":"),
}
"""Label, colour and line of each model."""

ERRORS = ("ellipsoid", "full", "quartic", "pressure", "no fit", "even load")
"""Short names of the models, for tables."""

LEGEND = (
    "rho: of the ellipsoid fitted to all pushes of the set, beside the mean distance "
    "of the load at rest to "
    "its centre, from the places of the pins or for an even load on the base. "
    "Friction: of object and board, "
    "from the forces. Errors: angle between predicted and measured direction of motion "
    "(vx, vy, 50 mm w), "
    "mean over pushes that were held out of the fit. No fit: from the places of the "
    "pins, or the outline of "
    "the base as a rigid face on an elastic board, and the weight alone."
)
CAPTION = (
    "Above, held-out pushes: how often the error is below a bound, and the turn that "
    "each push was predicted "
    "to make (mean over the splits) against the turn it made. Below, fitted to all "
    "pushes: force and moment "
    "of each push with the surfaces (the band spans the directions of the force), and "
    "the support with the "
    "loads at rest and the forces of the pushes."
)


def write_identification(
    identifications: Sequence[Identification], out: Path, how: str, notes: Sequence[str]
) -> Path:
    """Write ``out``/report.html and ``out``/plots/<set>.png and return the page's path.

    ``how`` describes how the pushes were split, ``notes`` the omitted data.
    """
    body = [
        "<h1>Support identified from pushes</h1>",
        f"<p>{escape(how)} {escape(LEGEND)}</p>",
    ]
    body.append(_tables(identifications))
    body += [f"<p>{escape(note)}</p>" for note in notes]
    for identification in identifications:
        name = identification.push_set.name
        picture = style.png(set_figure(identification))
        write_whole(out / "plots" / f"{name.replace('/', '-')}.png", picture)
        body.append(
            f"<section><h2>{escape(name)}</h2>{image(picture, name, CAPTION)}</section>"
        )
    return write_whole(
        out / "report.html", document("Support identified from pushes", "".join(body))
    )


def predicted_rho(identification: Identification) -> tuple[float, float | None]:
    """Two values of rho [m] predicted from the layout of the support: one for the load,
    one for a rigid face.

    The load is carried by the pins, or is even on the base. With pins there is no rigid
    face, and the second value is None.
    """
    uniform = identification.push_set.uniform_pressure()
    expected = rho_pole(identification.push_set.static_pressure())
    if uniform is None:
        return expected, None
    return rho_pole(uniform), expected


HEAD = (
    "set",
    "pushes",
    "friction",
    "rho",
    "rho predicted",
    "for a rigid face",
    *ERRORS,
)


def cells(identification: Identification) -> list[str]:
    """Table row of a set, in the columns of ``HEAD``.

    Rho is in [mm], mean held-out errors are in [deg]. Missing values are empty.
    """
    row = [
        identification.push_set.name,
        str(identification.push_set.count),
        f"{identification.pressure.friction:.3f}",
    ]
    for rho in (identification.ellipsoid.rho, *predicted_rho(identification)):
        row.append("" if rho is None else f"{1e3 * rho:.1f}")
    for model in MODELS:
        score = identification.scores.get(model)
        row.append("" if score is None else f"{math.degrees(score.mean):.1f}")
    return row


SUPPORTS = 5  # number of a support's figures in ``HEAD``, before the errors


def _tables(identifications: Sequence[Identification]) -> str:
    """A table of supports and a table of errors, neither wider than a page."""
    units = ["", "", "", *[" [mm]"] * 3, *[" [°]"] * len(MODELS)]
    head = [name + unit for name, unit in zip(HEAD, units, strict=True)]
    rows = [cells(identification) for identification in identifications]
    cut = 1 + SUPPORTS
    supports = _table(head[:cut], [row[:cut] for row in rows])
    errors = _table([head[0], *head[cut:]], [[row[0], *row[cut:]] for row in rows])
    return f"{supports}<h2>Held-out errors of the direction, by model</h2>{errors}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [
        [f'<th scope="row">{escape(name)}</th>', *number_cells(figures)]
        for name, *figures in rows
    ]
    return table(head, lines, numbers=len(head) - 1)


def summary(result: IdentifiedSet) -> list[str]:
    """Sentences on one set: parameters with intervals, clocks, and the next push."""
    name = result.models.push_set.name
    friction = result.intervals.friction
    rho = result.intervals.rho
    lines = [
        f"{name}: friction {friction.value:.3f} ({friction.low:.3f} to "
        f"{friction.high:.3f}), rho {1e3 * rho.value:.1f} mm ({1e3 * rho.low:.1f} to "
        f"{1e3 * rho.high:.1f}); {METHOD}."
    ]
    if result.recorded is not None:
        lines += _recorded_lines(result.recorded)
    lines += _load_line(result)
    lines.append(_next_line(result))
    return lines


def _recorded_lines(recorded: RecordedSet) -> list[str]:
    """Sentences on the tip's friction, and on the clocks."""
    lines = [
        f"{clock.source}: {1e3 * clock.offset.seconds:+.1f} ms "
        f"(± {1e3 * clock.offset.half_width:.1f}, least squares) added to the stamps of "
        "the object's poses."
        for clock in recorded.clocks
        if clock.offset.half_width
    ]
    if recorded.contact_friction is None:
        lines.append(
            "Contact friction: the tip did not slide; it is at least "
            f"{recorded.least_contact_friction:.2f}."
        )
    else:
        lines.append(
            f"Contact friction, where it slid: {recorded.contact_friction:.2f}."
        )
    return lines


def _load_line(result: IdentifiedSet) -> list[str]:
    """Sentence for a shape whose expected load predicts the pushes better than rho
    does.
    """
    if result.needs_rho:
        return []
    plain = math.degrees(result.expected_error)
    fitted = math.degrees(result.models.scores["ellipsoid"].mean)
    on_the_spot = 1e3 * rho_pole(result.models.pressure.at_rest)
    return [
        "The load that the shape leads to expect predicts held-out pushes better than "
        f"rho does ({plain:.1f} against {fitted:.1f} degrees): belief.rho is best null. "
        f"By the fitted load rho is {on_the_spot:.1f} mm for a turn on the spot."
    ]


def _next_line(result: IdentifiedSet) -> str:
    """Advice on the push that narrows the wider interval."""
    push = result.next_push
    interval = getattr(result.intervals, push.parameter)
    x, y = (1e3 * value for value in push.point)
    heading = math.degrees(math.atan2(push.direction[1], push.direction[0]))
    return (
        f"Known least: {push.parameter}, to {100.0 * interval.relative:.1f} %. Push the "
        f"object at ({x:.0f}, {y:.0f}) mm of its own frame, towards {heading:.0f} "
        f"degrees: {MORE} such pushes leave {100.0 * push.narrowed:.0f} % of the interval."
    )


def set_figure(identification: Identification) -> Figure:
    """Figure of one set: errors, turns, surface, support."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(style.SETTINGS):
        made = Figure(
            figsize=(style.WIDTH + 1.0, 7.6), dpi=style.DPI, layout="constrained"
        )
        (errors, turns), (surface, support) = made.subplots(2, 2)
        _errors(errors, identification)
        _turns(turns, identification)
        _surface(surface, identification)
        _support(support, identification)
    return made


def _errors(axes: Axes, identification: Identification) -> None:
    for name, (label, color, line) in MODELS.items():
        if name in identification.scores:
            misses = np.concatenate(identification.scores[name].errors)
            errors = np.sort(np.degrees(misses))
            share = 100.0 * np.arange(1, len(errors) + 1) / len(errors)
            axes.plot(
                errors,
                share,
                line,
                color=color,
                label=f"{label}: mean {errors.mean():.1f}°",
            )
    axes.set_xlim(0.0, 45.0)
    axes.set_ylim(0.0, 101.0)
    axes.set_xlabel("error of the direction [deg]")
    axes.set_ylabel("held-out pushes below [%]")
    axes.legend(loc="lower right", frameon=True, framealpha=0.9, edgecolor="none")
    style.title(axes, "How far predictions are off")


def _turns(axes: Axes, identification: Identification) -> None:
    measured = _turn(identification.push_set.pairs.directions)
    axes.plot((-90.0, 90.0), (-90.0, 90.0), color=style.PALE, lw=1.2, zorder=1)
    for name, mark, size in (("ellipsoid", "x", 22), ("pressure", "o", 16)):
        label, color, _ = MODELS[name]
        predicted = _turn(identification.scores[name].mean_directions)
        axes.scatter(
            measured,
            predicted,
            size,
            color=color,
            marker=mark,
            linewidths=1.0,
            label=label,
            zorder=2,
        )
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_ticks(range(-90, 91, 30))
    axes.set_xlabel("measured turn, atan(50 mm w / v) [deg]")
    axes.set_ylabel("predicted, held out [deg]")
    axes.legend(loc="upper left")
    style.title(axes, "Turn against translation")


def _turn(directions: Array) -> Array:
    out: Array = np.degrees(np.arcsin(np.clip(directions[:, 2], -1.0, 1.0)))
    return out


def _surface(axes: Axes, identification: Identification) -> None:
    w = identification.push_set.pairs.wrenches
    angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 61)
    outline = np.stack(
        [np.cos(angle), 1e3 * identification.ellipsoid.rho * np.sin(angle)]
    )
    radius = _radius(identification, angle)
    band = np.hstack([radius.min(1) * outline, (radius.max(1) * outline)[:, ::-1]])
    axes.fill(*band, color=style.SKY, alpha=0.35, lw=0.0, label=MODELS["pressure"][0])
    label, color, _ = MODELS["ellipsoid"]
    axes.plot(*(identification.ellipsoid.max_force * outline), color=color, label=label)
    force = np.hypot(w[:, 0], w[:, 1])
    axes.scatter(
        force, 1e3 * w[:, 2], 14, color=style.BLACK, zorder=3, label="measured"
    )
    axes.set_xlim(left=0.0)
    axes.set_xlabel("force [N]")
    axes.set_ylabel("moment about the CoM [N mm]")
    axes.legend(loc="center left")
    style.title(axes, "Limit surface: force and moment while sliding")


def _radius(identification: Identification, angle: Array) -> Array:
    """Norm [N] of (|F|, tau / rho) on the fitted surface as a function of the angle
    atan2(tau / rho, |F|).

    There is one column for each of 24 directions of the force. All values are for the
    loads at rest.
    """
    turn = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    steep, around = np.meshgrid(angle, turn, indexing="ij")
    flat = np.cos(steep)
    moment = identification.ellipsoid.rho * np.sin(steep)
    wrenches = np.stack(
        [flat * np.cos(around), flat * np.sin(around), moment], axis=2
    ).reshape(-1, 3)
    levels = identification.pressure.slides(wrenches, np.zeros(len(wrenches)))[1]
    out: Array = (identification.pressure.max_force / levels).reshape(steep.shape)
    return out


def _support(axes: Axes, identification: Identification) -> None:
    push_set = identification.push_set
    outline = 1e3 * np.array([*push_set.base, push_set.base[0]])
    axes.plot(*outline.T, color=style.GREY, lw=1.2, label="base")
    _loads(axes, identification)
    contacts = 1e3 * push_set.pairs.contacts
    forces = push_set.pairs.wrenches[:, :2]
    axes.quiver(
        *contacts.T,
        *forces.T,
        pivot="tip",
        angles="xy",
        scale_units="xy",
        scale=0.22,
        width=0.003,
        color=style.ORANGE,
        label="forces",
    )
    axes.plot(0.0, 0.0, "+", color=style.BLACK, ms=9, label="CoM")
    axes.set_aspect("equal")
    axes.margins(0.14)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.legend(loc="upper right")
    style.title(axes, "Fitted load at rest, and the pushes")


def _loads(axes: Axes, identification: Identification) -> None:
    """Draw the fitted load at rest: the shares of the pins, or the pressure on the
    base.
    """
    pressure = identification.pressure
    points = 1e3 * pressure.points
    if identification.push_set.pins:
        axes.scatter(*points.T, 900.0 * pressure.shares, color=style.SKY, lw=0.0)
        for point, share in zip(points, pressure.shares, strict=True):
            axes.annotate(
                f"{100.0 * share:.0f} %", point, ha="center", va="center", fontsize=8
            )
    else:
        areas = pressure.radii**2
        ratio = pressure.shares / areas * areas.sum()
        spots = axes.scatter(
            *points.T, 22, c=ratio, cmap="cividis_r", vmin=0.0, vmax=3.0, lw=0.0
        )
        axes.figure.colorbar(
            spots, ax=axes, label="pressure over its mean", shrink=0.8, extend="max"
        )
