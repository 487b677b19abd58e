"""Common interface of the reduced models of all modes."""

from __future__ import annotations

from typing import Protocol

from pushpressslide.core.pose import Point, Pose2


class Drive(Protocol):
    """The reduced model with which one segment is driven: frozen data.

    Classes are in ``rom/drives.py``, or in the file of a mode that brings its own.
    """

    @property
    def X_BV(self) -> Pose2:
        """Frame at the tracking point, x along the heading, in the body frame."""
        ...

    @property
    def max_friction(self) -> float:
        """Friction mu_s N [N] that resists straight sliding on the support."""
        ...

    @property
    def rho(self) -> float | None:
        """Length [m] that makes moments comparable with forces. With None the mode
        chooses its own.
        """
        ...

    @property
    def center(self) -> Point:
        """Reference point [m] in B of wrenches: the CoM, or for presses the CoP."""
        ...
