"""Named columns of a table, with the quantity and unit of each."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.log_options import LogOptions

OBJECT = ("object", "obj", "body", "box", "part", "slider")
TIP = ("tip0", "tip", "ee", "eef", "tcp", "probe", "tool", "pusher", "finger")
YAWS = ("yaw", "theta", "heading", "angle")
QUATERNION = ("qw", "qx", "qy", "qz")
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}
ANGLES = {"rad": 1.0, "deg": 0.017453292519943295, "degrees": 0.017453292519943295}
FORCES = {"n": 1.0, "mn": 1e-3, "kn": 1e3, "gf": 9.80665e-3}
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
PURE = {"1": 1.0}
UNIT = re.compile(r"^(.*?)[\s_]*[\[(]([^\])]*)[\])]\s*$")


@dataclass(frozen=True)
class Quantity:
    """A quantity that a column may hold."""

    name: str  # as in an exported CSV file, without the tip's number
    group: str  # ``time``, ``object``, ``tip``, ``yaw`` or ``force``
    units: dict[str, float]
    aliases: tuple[str, ...]


def _names(bodies: Sequence[str], suffixes: Sequence[str]) -> tuple[str, ...]:
    return tuple(
        f"{body}{pose}_{suffix}"
        for body in bodies
        for pose in ("", "_pose", "_position", "_pos")
        for suffix in suffixes
    )


def _times(bodies: Sequence[str]) -> tuple[str, ...]:
    return _names(bodies, ("t", "time", "stamp", "timestamp"))


def _forces(axis: str) -> tuple[str, ...]:
    plain = (f"f{axis}", f"force_{axis}", f"f_{axis}", f"wrench_force_{axis}")
    bodies = (*TIP, "ft", "wrench", "force", "measured", "sensor")
    return (*plain, *(f"{body}_{name}" for body in bodies for name in plain[:2]))


QUANTITIES = (
    Quantity("time", "time", TIMES, ("t", "time", "stamp", "timestamp", "secs")),
    Quantity("object_time", "time", TIMES, _times(OBJECT)),
    Quantity("tip_time", "time", TIMES, _times(TIP)),
    Quantity("force_time", "time", TIMES, _times(("force", "ft", "wrench"))),
    *(
        Quantity(f"object_{axis}", "object", LENGTHS, (axis, *_names(OBJECT, (axis,))))
        for axis in ("x", "y")
    ),
    Quantity("object_yaw", "yaw", ANGLES, (*YAWS, *_names(OBJECT, YAWS))),
    *(
        Quantity(f"object_{part}", "quaternion", PURE, _names(OBJECT, (part,)))
        for part in QUATERNION
    ),
    *(
        Quantity(f"tip_{axis}", "tip", LENGTHS, _names(TIP, (axis,)))
        for axis in ("x", "y", "z")
    ),
    Quantity("tip_yaw", "yaw", ANGLES, _names(TIP, YAWS)),
    *(Quantity(f"tip_f{axis}", "force", FORCES, _forces(axis)) for axis in ("x", "y")),
)
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}
GROUPS = tuple(dict.fromkeys(quantity.group for quantity in QUANTITIES))


@dataclass(frozen=True)
class Column:
    """A column of a table that holds a quantity."""

    index: int
    title: str  # as in the file
    factor: float  # factor from its unit to SI
    stated: bool  # whether the title or an option states its unit


def find_columns(
    source: str, titles: Sequence[str], options: LogOptions
) -> dict[str, Column]:
    """Columns of a table by the names of ``QUANTITIES``.

    A title may end in a unit: ``object_x [mm]``, ``object_x_mm``. Raises
    PushPressSlideError for an unknown unit, for two columns of one quantity, and for an
    option that names no quantity.
    """
    _check_options(options)
    found: dict[str, Column] = {}
    for index, title in enumerate(titles):
        quantity, unit = _meaning(title, options)
        if quantity is None:
            continue
        if quantity.name in found:
            first = found[quantity.name].title
            raise PushPressSlideError(
                f"{source}: columns {first!r} and {title!r} both hold {quantity.name}; "
                f"--column {quantity.name}=NAME names one"
            )
        stated = options.units.get(quantity.name, options.units.get(quantity.group))
        factor = _factor(source, title, quantity, stated or unit)
        known = (stated or unit) is not None
        found[quantity.name] = Column(index, title, factor, known)
    return found


def _check_options(options: LogOptions) -> None:
    for name, title in options.columns.items():
        if name not in BY_NAME:
            known = ", ".join(BY_NAME)
            raise PushPressSlideError(f"--column {name}={title}: allowed: {known}")
    for name, unit in options.units.items():
        if name not in BY_NAME and name not in GROUPS:
            known = ", ".join(GROUPS)
            raise PushPressSlideError(
                f"--unit {name}={unit}: allowed: {known}, or a column's quantity"
            )


def _meaning(title: str, options: LogOptions) -> tuple[Quantity | None, str | None]:
    """Quantity of a column, and the unit in its title. None if unknown or missing."""
    named = {column: name for name, column in options.columns.items()}
    if title in named:
        return BY_NAME[named[title]], _unit_in(title)[1]
    plain, unit = _unit_in(title)
    for quantity in QUANTITIES:
        if quantity.name in options.columns:
            continue
        if plain in quantity.aliases:
            return quantity, unit
        stem, _, end = plain.rpartition("_")
        if stem in quantity.aliases and end in quantity.units:
            return quantity, end
    return None, unit


def _unit_in(title: str) -> tuple[str, str | None]:
    """A title in lower case with underscores, and the unit in its brackets, or None."""
    match = UNIT.match(title)
    text = match.group(1) if match else title
    unit = match.group(2).strip().lower() if match else None
    plain = re.sub(r"[\s./:-]+", "_", text.strip().lower()).strip("_")
    return plain, unit


def _factor(source: str, title: str, quantity: Quantity, unit: str | None) -> float:
    if unit is None:
        return 1.0
    factor = quantity.units.get(unit.lower())
    if factor is None:
        raise PushPressSlideError(
            f"{source}: column {title!r}: unit {unit!r} is not allowed; allowed: "
            f"{', '.join(quantity.units)}"
        )
    return factor
