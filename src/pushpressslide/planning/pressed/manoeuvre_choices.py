"""Manoeuvre choices of a task, the safest press first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice

from pushpressslide.core.motion import Motion
from pushpressslide.core.plan import ENOUGH, Choice, Contact
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, enough_feasible
from pushpressslide.planning.either_arm import either_arm
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pressed.manoeuvre import Manoeuvre
from pushpressslide.planning.pressed.placements import PressPlacements
from pushpressslide.planning.pressed.ranking import by_time, soonest
from pushpressslide.planning.segments import describe_points

# of one motion of a sequence: contacts of each load that are tried, and manoeuvres by
# them. Of motions that are possible nine in ten are possible by one of these
FEW = 5
TRIED = 10
LOADS = 2  # number of loads that are tried


def manoeuvre_choices(
    query: MotionQuery,
    mode: str,
    placements: PressPlacements,
    enough: int,
    path_refusal: Callable[[Choice], Refusal | None],
) -> list[Choice]:
    """Choices of manoeuvres, in the order of ``turning``, until ``enough`` are
    feasible.

    One manoeuvre for each contact comes first, then the other manoeuvres, each for
    either arm, then the skipped contacts. A search over sequences has other motions to
    try: for its queries few manoeuvres are evaluated, and a contact that was out of
    reach is not tried with other loads.
    """
    ends = query.body_ends
    X_WB, _ = ends
    out: list[Choice] = []
    skipped: list[Choice] = []
    missing = enough
    groups = placements.turning(query.scene)
    for contacts in groups[:LOADS] if query.from_search else groups:
        ranked = _ranked(query, X_WB, contacts, out)
        wanted = min(missing, ENOUGH)
        for manoeuvre in _manoeuvres(query, X_WB, list(ranked)):
            driven = manoeuvre.choice(query, mode)
            for choice in either_arm(query.scene, ends, driven):
                if wanted > 0:
                    refusal = path_refusal(choice)
                else:
                    refusal = enough_feasible(enough - missing)
                out.append(choice.refused(refusal))
                wanted -= refusal is None
                missing -= refusal is None
            if wanted == 0:
                break
        if missing < enough and not skipped:
            tried = {_press(choice.contacts[0]) for choice in out}
            left = {c: time for c, time in ranked.items() if _press(c) not in tried}
            why = enough_feasible(enough - missing)
            skipped = _skipped(query.motion, mode, left, why)
        # other loads only if more choices are wanted
        if missing == 0 or missing < enough <= ENOUGH:
            break
    return sorted(out, key=lambda choice: not choice.feasible) + skipped


def _ranked(
    query: MotionQuery,
    X_WB: Pose2,
    contacts: Sequence[Contact],
    tried: Sequence[Choice],
) -> dict[Contact, float]:
    """Estimated time [s] of each contact, in the order in which to try the contacts."""
    if not query.from_search:
        return by_time(query, X_WB, contacts)
    ranked = by_time(query, X_WB, _still_reached(contacts, tried))
    return dict(islice(ranked.items(), FEW))


def _manoeuvres(
    query: MotionQuery, X_WB: Pose2, contacts: Sequence[Contact]
) -> Iterator[Manoeuvre]:
    """Yield the manoeuvres to try, in order."""
    every = soonest(query, X_WB, contacts)
    return islice(every, TRIED) if query.from_search else every


def _still_reached(
    contacts: Sequence[Contact], tried: Sequence[Choice]
) -> list[Contact]:
    """Contacts that were not tried, or were within reach in at least one trial."""
    lost: dict[Point, bool] = {}
    for choice in tried:
        point = choice.contacts[0].point
        unreached = choice.refusal is not None and choice.refusal.code == "reach"
        lost[point] = lost.get(point, True) and unreached
    return [contact for contact in contacts if not lost.get(contact.point, False)]


def _press(contact: Contact) -> tuple[Point, float]:
    """Place [m] and load [N] of a press, without its arm."""
    return contact.point, contact.load


def _skipped(
    motion: Motion, mode: str, times: Mapping[Contact, float], why: Refusal
) -> list[Choice]:
    """Choices of contacts for which no manoeuvre was planned, for the reason ``why``,
    with their estimated ``times`` [s].
    """
    return [
        Choice(
            mode,
            f"manoeuvre at {describe_points([contact.point])}",
            (contact,),
            time=time + overhead(motion, pressed=True),
            refusal=why,
        )
        for contact, time in times.items()
    ]
