"""Status numbers and layout of results, shared by the kernels of all allocators.

A result is (forces, normal forces, margin, status, residual), in the units of
``core.allocation``.
"""

from __future__ import annotations

Vector = tuple[float, float]
Wrench = tuple[float, float, float]

OK = 0
PROJECTED = 1
INFEASIBLE = 2
EXACT = (0.0, 0.0, 0.0)  # residual of a wrench that is given whole
GIVEN = 1e-9  # error that counts as zero, as a share of a wrench

One = tuple[tuple[Vector], tuple[float], float, int, Wrench]
"""Result for one contact."""
Two = tuple[tuple[Vector, Vector], Vector, float, int, Wrench]
"""Result for two contacts."""
