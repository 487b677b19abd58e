"""How large an installation is: downloaded and installed, without extras and with Drake.

Builds the wheel, installs it in new environments, and adds up the sizes of wheels and
of installed files, compiled ones included, pip's own left out. Exits with 1 where the
core is larger than it may be.
"""

from __future__ import annotations

import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
INSTALLED = 380.0  # MB, 1e6 bytes, that without extras it may take
DOWNLOADED = 110.0  # MB
NOT_OURS = ("pip", "pip-*", "setuptools", "setuptools-*", "pkg_resources")


@dataclass(frozen=True)
class Size:
    """Megabytes of an installation."""

    downloaded: float
    installed: float


def megabytes(folder: Path) -> float:
    """Return the size of all files below a folder."""
    return sum(f.stat().st_size for f in folder.rglob("*") if f.is_file()) / 1e6


def measured(folder: Path, extras: str) -> Size:
    """Install the package with ``extras``, as "[drake]", below an empty folder."""
    wheels = folder / "wheels"
    environment = folder / "environment"
    venv.create(environment, with_pip=True)
    pip = (environment / "bin" / "python", "-m", "pip", "--disable-pip-version-check")
    run(*pip, "wheel", "--quiet", "--wheel-dir", wheels, f"{ROOT}{extras}")
    offline = ("--no-index", "--find-links", wheels)
    run(*pip, "install", "--quiet", *offline, f"pushpressslide{extras}")
    (packages,) = environment.glob("lib/python*/site-packages")
    own = {path for pattern in NOT_OURS for path in packages.glob(pattern)}
    installed = megabytes(packages) - sum(megabytes(path) for path in own)
    return Size(megabytes(wheels), installed)


def run(*command: object) -> None:
    """Run a command; its errors end the script."""
    subprocess.run([str(word) for word in command], check=True)


def main() -> int:
    """Print both sizes; return the exit status."""
    print(f"{'MB':<24}{'downloaded':>12}{'installed':>12}")
    sizes = []
    for extras in ("", "[drake]"):
        with TemporaryDirectory() as folder:
            size = measured(Path(folder), extras)
        name = f"pushpressslide{extras}"
        print(f"{name:<24}{size.downloaded:>12.0f}{size.installed:>12.0f}", flush=True)
        sizes.append(size)
    core = sizes[0]
    fits = core.downloaded <= DOWNLOADED and core.installed <= INSTALLED
    if not fits:
        print(f"the core may take {DOWNLOADED:.0f} and {INSTALLED:.0f} MB")
    return 0 if fits else 1


if __name__ == "__main__":
    sys.exit(main())
