"""What the studies simulate in Drake beside runs: only this room imports pydrake.

Importing it, or any module of it, raises MissingPackageError where Drake is not
installed.
"""

import pushpressslide.sim  # noqa: F401  it raises
