"""Commands provided by other packages.

Such a package names functions with typer's annotations as entry points of the group
``pushpressslide.commands``. The name of an entry point is that of its command.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import typer

from pushpressslide.core.errors import MissingPackageError, PushPressSlideError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint, EntryPoints

GROUP = "pushpressslide.commands"
STUDIES = "pushpressslide-studies"
PACKAGES = {
    "bench": STUDIES,
    "footprints": STUDIES,
    "gym-pusht": STUDIES,
    "reproduce": STUDIES,
}
"""Packages that provide known commands, by command."""


@cache
def entries() -> EntryPoints:
    """Entry points of the installed packages."""
    from importlib.metadata import entry_points

    return entry_points(group=GROUP)


def commands() -> dict[str, Any]:
    """Commands of the installed packages, by name.

    Raises PushPressSlideError for a command that does not match this version.
    """
    return {item.name: _command(item) for item in entries()}


def _command(entry_point: EntryPoint) -> Any:
    """Command of an entry point, as the parser needs it."""
    try:
        function = entry_point.load()
    except (ImportError, AttributeError) as error:
        raise PushPressSlideError(
            f"{entry_point.name}: {entry_point.value} cannot be imported ({error}); install versions of "
            "both packages that belong together"
        ) from error
    alone = typer.Typer(add_completion=False, rich_markup_mode=None)
    alone.command(entry_point.name)(function)
    return typer.main.get_command(alone)


def check_installed(name: str) -> None:
    """Raise MissingPackageError if another package would provide this command."""
    package = PACKAGES.get(name)
    if package is not None and name not in entries().names:
        raise MissingPackageError(
            f"{name}: {package} is not installed; pip install {package}"
        )
