"""Structural checks of a robot's file: a tree of bodies with mass, and driven joints up
to the tip.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pushpressslide.core.errors import Shown
from pushpressslide.robots.facts import JointFacts
from pushpressslide.robots.file_values import UnfitValue

WORLD = "world"
SHOWN = 300  # longest list of names, in characters


def few(names: Iterable[str]) -> str:
    """The names in one line, truncated if there are many."""
    return ", ".join(names)[:SHOWN]


def check_tree(links: Sequence[str], joints: Sequence[JointFacts]) -> None:
    """Raise UnfitValue for a duplicate name, a joint to a missing link, a link that is
    the child of two joints, or a loop.
    """
    _check_names("link", links)
    _check_names("joint", [joint.name for joint in joints])
    known = {*links, WORLD}
    by_child: dict[str, JointFacts] = {}
    for joint in joints:
        for end, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                place = f"joint {joint.name!r}, {end}"
                raise UnfitValue(place, link, f"a link of the file: {few(links)}")
        other = by_child.setdefault(joint.child, joint)
        if other is not joint:
            reason = f"one joint to each link; {other.name!r} leads to it already"
            raise UnfitValue(f"joint {joint.name!r}, child", joint.child, reason)
    for joint in joints:
        _check_way_to_root(joint, by_child)


def _check_names(what: str, names: Sequence[str]) -> None:
    taken: set[str] = set()
    for name in names:
        if name in taken:
            raise UnfitValue(f"{what} {name!r}", Shown("a second one"), "one of a name")
        taken.add(name)


def _check_way_to_root(joint: JointFacts, by_child: Mapping[str, JointFacts]) -> None:
    """Raise UnfitValue if the joints above ``joint`` form a loop."""
    link = joint.parent
    passed = {joint.child}
    while link in by_child:
        if link in passed:
            reason = "a link nearer to the root; the joints go round in a circle"
            raise UnfitValue(f"joint {joint.name!r}, parent", joint.parent, reason)
        passed.add(link)
        link = by_child[link].parent
    if link in passed:
        reason = "another link than its child"
        raise UnfitValue(f"joint {joint.name!r}, parent", joint.parent, reason)


def check_moving(moving: Sequence[JointFacts], mimics: Mapping[str, str]) -> None:
    """Raise UnfitValue for an undriven joint between root and tip."""
    for joint in moving:
        followed = mimics.get(joint.name)
        if followed:
            reason = "no mimic on the way to the tip: each joint is driven by itself"
            value = Shown(f"mimic of {followed!r}")
            raise UnfitValue(f"joint {joint.name!r}", value, reason)
        if joint.effort < 0.0:
            reason = "above 0, or none given for no limit"
            raise UnfitValue(
                f"joint {joint.name!r}, limit effort", joint.effort, reason
            )


def check_masses(
    moving: Sequence[JointFacts],
    joints: Sequence[JointFacts],
    masses: Mapping[str, float],
) -> None:
    """Raise UnfitValue if one of the ``moving`` joints carries no mass.

    ``joints`` are all joints, ``masses`` [kg] those of the links.
    """
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    for joint in moving:
        if not _carries(joint.child, below, masses):
            reason = f"above 0: all that joint {joint.name!r} moves has no mass"
            raise UnfitValue(f"link {joint.child!r}, mass", Shown("0 kg"), reason)


def _carries(
    link: str, below: Mapping[str, Sequence[str]], masses: Mapping[str, float]
) -> bool:
    """Whether a link, or any link attached to it, has mass."""
    left = [link]
    while left:
        name = left.pop()
        if masses.get(name, 0.0) > 0.0:
            return True
        left += below.get(name, ())
    return False
