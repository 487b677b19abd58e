"""Identification of rho, friction and pressure from recorded pushes.

The models are scored on held-out pushes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import write_whole
from pushpressslide.identification.pairs import LENGTH
from pushpressslide.identification.push_sets import load_sets
from pushpressslide.identification.scoring import Identification, identified
from pushpressslide.mechanics.rho import rho_pole
from pushpressslide.report.identification import predicted_rho, write_identification
from pushpressslide.report.json_text import to_json
from pushpressslide.report.metrics import installed_versions

SCHEMA = 1
Progress = Callable[[float, float], None]


def identify(
    data: Path,
    *,
    out: Path,
    seed: int = 0,
    splits: int = 20,
    fit_share: float = 0.5,
    progress: Progress | None = None,
) -> tuple[dict[str, Any], list[Identification]]:
    """Identify every set of pushes in ``data``, a log or a folder with logs.

    Returns the contents of result.json, and the identifications. Writes result.json,
    report.html and a plot of each set to ``out``. Raises PushPressSlideError for logs
    that cannot be read.
    """
    sets, passed_over = load_sets(data)
    identifications = []
    for done, push_set in enumerate(sets):
        moved = _overall(progress, done, len(sets))
        identifications.append(identified(push_set, fit_share, splits, seed, moved))
    notes = _notes(identifications, passed_over)
    result = {
        "schema": SCHEMA,
        "data": str(data),
        "seed": seed,
        "splits": splits,
        "fit_share": fit_share,
        "length_scale": LENGTH,
        "sets": {each.push_set.name: _figures(each) for each in identifications},
        "mean_error_reduction": _reductions(identifications),
        "notes": notes,
        "versions": installed_versions(),
    }
    # of an older run: a folder that has one is complete
    (out / "result.json").unlink(missing_ok=True)
    shares = f"{100.0 * fit_share:g} % of each set's pushes fitted, the rest held out"
    how = f"{splits} random splits, {shares}."
    write_identification(identifications, out, how, notes)
    write_whole(out / "result.json", to_json(result))
    return result, identifications


def _overall(progress: Progress | None, done: int, sets: int) -> Progress:
    """Progress callback for one set that adds to the progress over the ``sets``."""

    def report_progress(part: float, parts: float) -> None:
        """Report progress within the current set."""
        if progress is not None:
            progress(done + part / parts, sets)

    return report_progress


def _figures(one: Identification) -> dict[str, Any]:
    """Figures of one set in result.json; SI units, radians."""
    push_set = one.push_set
    layout, rigid = predicted_rho(one)
    return {
        "logs": [recording.path.name for recording in push_set.recordings],
        "pushes": len(push_set.pairs),
        "refused": list(push_set.refused),
        "pins": [list(pin) for pin in push_set.pins] or None,
        "loads": one.pressure.shares.tolist() if push_set.pins else None,
        "contact_height": float(push_set.pairs.heights.mean()),
        "friction": one.pressure.friction,
        "friction_ellipsoid": one.ellipsoid.max_force / push_set.weight,
        "rho": one.ellipsoid.rho,
        "rho_predicted": layout,
        "rho_predicted_rigid_face": rigid,
        "rho_pressure": rho_pole(one.pressure.at_rest),
        "errors": {
            name: {"mean": s.mean, "spread": s.spread} for name, s in one.scores.items()
        },
    }


def _reductions(identifications: Sequence[Identification]) -> dict[str, float]:
    """Mean over the sets of 1 - error / error of the one-parameter ellipsoid, by model."""
    names = [
        name
        for name in identifications[0].scores
        if all(name in each.scores for each in identifications)
    ]
    return {
        name: sum(
            1.0 - each.scores[name].mean / each.scores["ellipsoid"].mean
            for each in identifications
        )
        / len(identifications)
        for name in names
    }


def _notes(
    identifications: Sequence[Identification], passed_over: Sequence[str]
) -> list[str]:
    """Notes on unused data, and on what a set's name leaves open."""
    notes = []
    for each in identifications:
        if each.push_set.layout_note:
            notes.append(f"{each.push_set.name}: {each.push_set.layout_note}")
        notes += [
            f"{each.push_set.name}: {line} (not used)."
            for line in each.push_set.refused
        ]
        for recording in each.push_set.recordings:
            held = len(recording.pushes)
            announced = recording.announced
            if held != announced:
                notes.append(
                    f"{recording.path.name}: announces {announced} pushes, holds "
                    f"{held}."
                )
    return [*notes, *passed_over]
