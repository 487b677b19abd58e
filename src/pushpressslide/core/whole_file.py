"""Atomic writing: a file is either complete or absent."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pushpressslide.core.errors import WriteError

PART = ".part"
"""Mark in the name of an unfinished file: ``.name.process.part``."""


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Context of a temporary file that becomes ``path`` when the block ends.

    Creates missing folders. An older file stays in place until the new one is complete
    and on the disk. Raises WriteError if the file cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}{PART}{path.suffix}")
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            _flush(temporary)
            os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write ``path`` under a temporary name, rename it when complete, and return
    ``path``.

    Creates missing folders; text is UTF-8. An older file stays in place until the new
    one is complete. Raises WriteError if the file cannot be written.
    """
    with whole(path) as temporary:
        temporary.write_bytes(utf8(data) if isinstance(data, str) else data)
    return path


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn a file system error inside the block into a WriteError about ``path``."""
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        raise WriteError(path, error) from error


def utf8(text: str) -> bytes:
    """The text in UTF-8. Command-line bytes in any other encoding are replaced."""
    try:
        return text.encode("utf-8")
    except UnicodeEncodeError:
        raw = text.encode("utf-8", "surrogateescape")
        return raw.decode("utf-8", "replace").encode("utf-8")


def remove_parts(folder: Path) -> None:
    """Remove half-written files left in a folder by a killed process."""
    for path in folder.rglob(f".*{PART}*"):
        with suppress(OSError):
            path.unlink()


def _flush(path: Path) -> None:
    """Flush a file to the disk before it is renamed, so that its final name never
    exists without its content.
    """
    with path.open("rb") as file:
        os.fsync(file.fileno())
