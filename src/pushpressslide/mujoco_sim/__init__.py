"""MuJoCo as the second simulator: the only package that imports mujoco.

Importing it, or any module of it, raises MissingPackageError if MuJoCo is not
installed.
"""

from importlib.util import find_spec

from pushpressslide.core.errors import MissingPackageError

if find_spec("mujoco") is None:
    raise MissingPackageError(
        "engine mujoco: MuJoCo is not installed; pip install 'pushpressslide[mujoco]' "
        "installs it, --engine drake and --engine planar do without"
    )
