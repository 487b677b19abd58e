"""How much a contact's force turns an object, as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Turning(NamedTuple):
    """R [m^2] at force angles [rad] from the line that leads from the CoM to the
    contact, ascending within a turn; one angle where it does not depend on it.
    """

    angles: Sequence[float]
    values: Sequence[float]
