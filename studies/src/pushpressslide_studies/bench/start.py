"""Start-up time of whole processes, compared with ``import numpy``."""

from __future__ import annotations

import subprocess
import sys

from pushpressslide_studies.bench.compared import Row, compared

PROGRAMS = {
    "import numpy": ("-c", "import numpy"),
    "import pushpressslide": ("-c", "import pushpressslide"),
    "pps --help": ("-m", "pushpressslide", "--help"),
    "pps tasks": ("-m", "pushpressslide", "tasks"),
    "import pydrake.all": ("-c", "import pydrake.all"),
}


def start() -> list[Row]:
    """A row for each program: its wall time, and the ratio to ``import numpy``."""

    def program(*words: str) -> None:
        command = [sys.executable, *words]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    return compared({name: [(program, words)] for name, words in PROGRAMS.items()})
