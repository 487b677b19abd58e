"""The type of the arrays of this package."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Double-precision floats of any shape; docstrings name the shape, like (n, 2)."""
