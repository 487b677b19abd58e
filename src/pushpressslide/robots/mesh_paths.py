"""Paths of the meshes named in a robot's file, inside the file's package or next to it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

PACKAGE_PATHS = "ROS_PACKAGE_PATH"
"""Environment variable with the folders that contain packages."""
HEIGHT = 8
"""Number of folders above a file that are searched for its package."""


class MeshPaths:
    """Finds the meshes of one file.

    Nothing is read outside the file's package, the packages next to it, and the named
    packages.
    """

    def __init__(self, file: Path, packages: Sequence[str] = ()) -> None:
        """Prepare the search around ``file``. Each of ``packages`` is a package, or a
        folder that contains packages.
        """
        self._folder = file.resolve().parent
        given = filter(None, os.environ.get(PACKAGE_PATHS, "").split(os.pathsep))
        self._given = [Path(text) for text in (*packages, *given)]
        above = list(self._folder.parents)[:HEIGHT]
        self._above = [self._folder, *above]
        root = next((f for f in self._above if (f / "package.xml").is_file()), None)
        # a package may use the packages next to it; else meshes are near the file
        self._root = root.parent if root else self._above[min(2, len(self._above) - 1)]

    def find(self, uri: str) -> Path | None:
        """Path of an existing file, or None."""
        for path in self._candidates(uri):
            whole = path.resolve()
            if whole.is_file() and self._allowed(whole):
                return whole
        return None

    def _candidates(self, uri: str) -> Iterator[Path]:
        match = re.match(r"(package|model)://([^/]+)/(.*)", uri)
        if match is None:
            yield self._folder / uri.removeprefix("file://")
            return
        name, rest = match[2], match[3]
        for folder in self._packages(name):
            yield folder / rest

    def _packages(self, name: str) -> Iterator[Path]:
        """Folders that may be a package, the most certain first."""
        for folder in self._above:
            if package_name(folder) == name:
                yield folder
        for folder in self._above:
            if folder.name == name:
                yield folder
        for folder in self._above:
            yield folder / name
        for place in self._given:
            yield place / name
            if package_name(place) == name or place.name == name:
                yield place

    def _allowed(self, path: Path) -> bool:
        """Whether a file is in the robot's package, in a package next to it, or in a
        named package.
        """
        places = (self._root, *self._given)
        return any(path.is_relative_to(place.resolve()) for place in places)


def package_name(folder: Path) -> str | None:
    """Name in a folder's package.xml, or None."""
    file = folder / "package.xml"
    if not file.is_file():
        return None
    match = re.search(
        r"<name>\s*([^<\s]+)\s*</name>", file.read_text("utf-8", "replace")
    )
    return match[1] if match else None


def readable(path: Path) -> bool:
    """Whether the installed libraries can read a mesh of this format."""
    return path.suffix.lower() != ".dae" or find_spec("collada") is not None
