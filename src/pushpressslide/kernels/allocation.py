"""What the kernels of all allocators share: their statuses, as numbers, and their answers
(forces, normal forces, margin, status, residual); ``core.allocation`` says the units.
"""

from __future__ import annotations

Vector = tuple[float, float]
Wrench = tuple[float, float, float]

OK = 0
PROJECTED = 1
INFEASIBLE = 2
EXACT = (0.0, 0.0, 0.0)  # residual of a wrench that is given whole
GIVEN = 1e-9  # of a wrench: an error that is none

One = tuple[tuple[Vector], tuple[float], float, int, Wrench]
"""The answer of one contact."""
Two = tuple[tuple[Vector, Vector], Vector, float, int, Wrench]
"""The answer of two contacts."""
