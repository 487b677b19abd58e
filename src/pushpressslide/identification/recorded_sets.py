"""Sets of pushes from recordings with streams. A task describes the object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import ObjectModel, Scene
from pushpressslide.identification.clock_offset import ClockOffset
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.pairs import Pairs
from pushpressslide.identification.push_sets import (
    LEAST_PUSHES,
    PushedObject,
    PushSet,
    check_count,
)
from pushpressslide.identification.push_windows import PushedWindows, push_windows
from pushpressslide.identification.streams import Stream, Streams
from pushpressslide.identification.tip_contact import TipContact

SLIP = 4e-3  # [m] travel along the face in a window above which the tip slides
FRICTIONS = (0.02, 3.0)  # range of a support's friction
LEAST_SLIDING = 3  # smallest number of windows for the friction of the tip


@dataclass(frozen=True)
class RecordedClock:
    """Offset of the poses' clock in one recording."""

    source: str
    offset: ClockOffset


@dataclass(frozen=True, eq=False)
class RecordedSet:
    """Pushes from recordings, as one set."""

    push_set: PushSet
    clocks: tuple[RecordedClock, ...]
    contact_friction: float | None  # friction of the tip; None: it did not slide
    least_contact_friction: float  # 95th percentile of the ratio of forces


def pushed_object(scene: Scene) -> PushedObject:
    """The object of a scene. Raises PushPressSlideError if its weight does not press on
    the support.
    """
    if scene.weight_on <= 0.0:
        raise PushPressSlideError(
            "support.kind: wall is not allowed; pushes on a table or an incline are "
            "identified"
        )
    body = scene.body
    return PushedObject(body.shape.base_corners, body.center_of_mass, scene.weight_on)


def recorded_set(
    name: str, recordings: Sequence[Streams], scene: Scene, options: LogOptions
) -> RecordedSet:
    """One set of all pushes of complete recordings.

    Raises PushPressSlideError for recordings without usable pushes, and for forces that
    no support friction explains.
    """
    body = pushed_object(scene)
    notes: list[str] = []
    found: list[PushedWindows] = []
    for streams in recordings:
        whole, note = _with_tip_height(streams, scene.body, options)
        notes += [note] if note else []
        contact = _tip_contact(whole, scene, options)
        found.append(push_windows(whole, contact, body.center_of_mass, options))
    pairs = _stacked([each.pairs for each in found])
    refused = tuple(line for each in found for line in each.refused)
    firsts = np.cumsum([0, *(each.numbers.max() for each in found[:-1])])
    numbers = np.concatenate(
        [each.numbers + first for each, first in zip(found, firsts, strict=True)]
    )
    check_count(name, len(pairs), len(pairs) + len(refused), refused)
    pushes = len(np.unique(numbers))
    if pushes < LEAST_PUSHES:
        numbers = np.arange(len(pairs))
        notes.append(
            f"{name}: holds {pushes} of at least {LEAST_PUSHES} pushes; their windows "
            "count as pushes, which makes intervals and errors smaller."
        )
    _check_forces(name, pairs, body.weight)
    made = PushSet(
        name,
        body,
        tuple(Path(streams.source).name for streams in recordings),
        (),
        pairs,
        numbers,
        refused,
        tuple(dict.fromkeys([*notes, *(n for each in found for n in each.notes)])),
    )
    clocks = tuple(
        RecordedClock(streams.source, each.offset)
        for streams, each in zip(recordings, found, strict=True)
    )
    return RecordedSet(made, clocks, *tip_friction(found))


def _tip_contact(streams: Streams, scene: Scene, options: LogOptions) -> TipContact:
    """The tip and the outline of the object at its height."""
    height = 0.0 if streams.tip is None else float(np.median(streams.tip.values[:, 2]))
    outline = scene.body.shape.section(height).placed(Pose2())
    radius = options.tip_radius
    return TipContact(outline, scene.tip_radius if radius is None else radius)


def _with_tip_height(
    streams: Streams, body: ObjectModel, options: LogOptions
) -> tuple[Streams, str]:
    """Streams with the height [m] of the tip above the support, and a note if the
    height is assumed.
    """
    tip = streams.tip
    if tip is None:
        raise PushPressSlideError(f"{streams.source}: tip missing")
    note = ""
    values = tip.values.copy()
    if options.tip_height is not None:
        values[:, 2] = options.tip_height
    elif np.isnan(values[:, 2]).any():
        values[:, 2] = 0.5 * body.shape.height
        note = (
            f"{streams.source}: no height of the tip; assumed to be "
            f"{500.0 * body.shape.height:.0f} mm, half of the object's (--tip-height)."
        )
    return replace(streams, tip=Stream(tip.times, values)), note


def _stacked(parts: Sequence[Pairs]) -> Pairs:
    return Pairs(
        np.concatenate([part.wrenches for part in parts]),
        np.concatenate([part.twists for part in parts]),
        np.concatenate([part.contacts for part in parts]),
        np.concatenate([part.heights for part in parts]),
    )


def _check_forces(source: str, pairs: Pairs, weight: float) -> None:
    """Raise PushPressSlideError if the forces cannot be those of a push."""
    force = float(np.median(np.hypot(*pairs.wrenches[:, :2].T)))
    ratio = force / weight
    low, high = FRICTIONS
    if low <= ratio <= high:
        return
    raise PushPressSlideError(
        f"{source}: a force of {force:.3g} N at a load of {weight:.3g} N is not allowed; "
        f"allowed: {low:g} to {high:g} times it; --unit force=N|mN|gf, or object.mass"
    )


def tip_friction(recordings: Sequence[PushedWindows]) -> tuple[float | None, float]:
    """Friction of the tip, and the 95th percentile of the ratios of tangential to
    normal force.

    The friction is None if the tip does not slide.
    """
    ratios = []
    sliding = []
    for each in recordings:
        force = each.pairs.wrenches[:, :2]
        along = (force * each.normals).sum(1)
        across = np.abs(
            force[:, 1] * each.normals[:, 0] - force[:, 0] * each.normals[:, 1]
        )
        own = across / np.maximum(along, 1e-9)
        ratios += own.tolist()
        sliding += own[each.travels > SLIP].tolist()
    largest = float(np.percentile(ratios, 95.0))
    if len(sliding) < LEAST_SLIDING:
        return None, largest
    return float(np.median(sliding)), largest
