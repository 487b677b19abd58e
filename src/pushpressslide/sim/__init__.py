"""The physics engine: the only package that imports pydrake.

Importing it, or any module of it, raises MissingPackageError if Drake is not installed.
"""

from importlib.util import find_spec

from pushpressslide.core.errors import MissingPackageError

if find_spec("pydrake") is None:
    raise MissingPackageError(
        "engine drake: Drake is not installed; pip install 'pushpressslide[drake]' "
        "installs it, --engine planar does without"
    )
