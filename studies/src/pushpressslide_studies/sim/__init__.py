"""What the studies simulate in Drake beside runs: the only room here that imports pydrake.

Importing it, or any module of it, raises MissingPackageError where Drake is not
installed.
"""

import pushpressslide.sim  # noqa: F401  it raises
