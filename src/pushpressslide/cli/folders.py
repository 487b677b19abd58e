"""Folders of results. Each is written by one command at a time."""

from __future__ import annotations

import errno
import fcntl
import os
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import count
from pathlib import Path

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.whole_file import PART, remove_parts

LOCK = ".pps.lock"
"""Lock file of a folder in which a command writes.

It names the process. The system releases the lock when that process ends, for whatever
reason.
"""
SHOWN = 8  # names of files in a message


@dataclass(frozen=True)
class _LockedFolder:
    """A folder locked by this process."""

    path: Path  # of the lock
    file: int  # descriptor


_made: list[Path] = []  # folders made by this command, removed if empty
_held: list[_LockedFolder] = []


def results_folder(
    out: Path | None,
    name: str,
    force: bool,
    results: tuple[str, ...] = ("result.json",),
    lock: str = LOCK,
) -> Path:
    """Folder for results, locked by this process until ``leave_folders``.

    Without ``out`` a new folder below runs/ is made. A new folder that is still empty
    at the end of the command is removed. Raises PushPressSlideError if the folder
    cannot be made, if another process writes in it (even with ``force``), or if it
    holds one of ``results`` without ``force``. ``lock`` is the name of the lock file.
    """
    if out is None:
        return hold(_new_folder(name), lock)
    hold(out, lock)
    present = [result for result in results if (out / result).exists()]
    if present and not force:
        raise PushPressSlideError(
            f"--out: {str(out)!r} is not allowed; it holds {present[0]} already; give "
            "another folder, or --force"
        )
    return out


def hold(folder: Path, lock: str = LOCK) -> Path:
    """Make a folder if it is missing, lock it for this process, and return it.

    Partial files left by a killed process are removed. Raises PushPressSlideError if
    the folder cannot be written, or if another process has locked it.
    """
    path = folder / lock
    if any(held.path.absolute() == path.absolute() for held in _held):
        return folder
    try:
        _make(folder)
        left = path.exists()
        file = _locked(path)
    except BlockingIOError:
        raise _in_use(folder, path) from None
    except (OSError, ValueError) as error:
        raise _not_writable(folder, error) from None
    _held.append(_LockedFolder(path, file))
    if left and lock == LOCK:
        remove_parts(folder)
    return folder


def leave_folders() -> None:
    """Unlock the folders, and remove new ones that are still empty."""
    while _held:
        held = _held.pop()
        with suppress(OSError):
            held.path.unlink()
        os.close(held.file)
    while _made:
        with suppress(OSError):
            _made.pop().rmdir()


def kept_files() -> str:
    """List of the complete files in this command's folders, for the end of a message.

    Files of the folders themselves come before those of subfolders.
    """
    out = ""
    for folder in (held.path.parent for held in _held if held.path.name == LOCK):
        paths = (path.relative_to(folder) for path in folder.rglob("*"))
        whole = [path for path in paths if _is_result(folder, path)]
        whole.sort(key=lambda path: (len(path.parts), path))
        more = f" and {len(whole) - SHOWN} more" if len(whole) > SHOWN else ""
        listed = ", ".join(map(str, whole[:SHOWN])) or "nothing"
        out += f"; whole in {folder}: {listed}{more}"
    return out


def _is_result(folder: Path, path: Path) -> bool:
    """Whether a path below a folder is a complete file."""
    return (folder / path).is_file() and path.name != LOCK and PART not in path.name


def _locked(path: Path) -> int:
    """Descriptor of a locked file.

    Raises BlockingIOError if another process has locked it.
    """
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _lock(file)
            # whoever held it last may have removed it meanwhile
            if path.exists() and os.path.samestat(os.fstat(file), path.stat()):
                os.ftruncate(file, 0)
                os.write(file, f"{os.getpid()}\n".encode())
                return file
        except OSError:
            os.close(file)
            raise
        os.close(file)


def _lock(file: int) -> None:
    """Lock a file, if the file system supports locks."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise
    except OSError as error:
        if error.errno not in (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS):
            raise


def _make(folder: Path) -> None:
    """Make a folder with its parents, and record which of them are new."""
    if folder.is_dir():
        return
    if folder.parent != folder:
        _make(folder.parent)
    with suppress(FileExistsError):
        folder.mkdir()
        _made.append(folder)
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "a file of that name is there")


def _new_folder(name: str) -> Path:
    """Make a new folder below runs/, and return it."""
    runs = Path("runs")
    stamp = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    for n in count(1):
        folder = runs / (stamp if n == 1 else f"{stamp}-{n}")
        try:
            folder.mkdir(parents=True)
            break
        except FileExistsError as error:
            if not runs.is_dir():
                raise _not_writable(folder, error) from None
        except OSError as error:
            raise _not_writable(folder, error) from None
    _made.append(folder)
    return folder


def _in_use(folder: Path, lock: Path) -> PushPressSlideError:
    process = "another process"
    with suppress(OSError, ValueError):
        process = f"process {int(lock.read_text())}"
    return PushPressSlideError(
        f"--out: {str(folder)!r} is not allowed; {process} is writing in it, which "
        "--force does not stop; wait for it, or give another folder"
    )


def _not_writable(folder: Path, error: Exception) -> PushPressSlideError:
    reason = getattr(error, "strerror", None) or str(error)
    return PushPressSlideError(
        f"--out: {str(folder)!r} is not allowed; allowed: a folder that can be written "
        f"({reason})"
    )
