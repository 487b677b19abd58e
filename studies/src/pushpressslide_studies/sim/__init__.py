"""Drake simulations for comparison with runs.

This is the only package of the studies that imports pydrake. Importing it, or any
module of it, raises MissingPackageError if Drake is not installed.
"""

import pushpressslide.sim  # noqa: F401  it raises
