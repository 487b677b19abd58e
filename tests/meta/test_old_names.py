"""What was moved is still found under its old name, for one version."""

import subprocess
import sys
from pathlib import Path

import pytest


def python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run code in a Python of its own, with every deprecation shown."""
    return subprocess.run(
        [sys.executable, "-W", "always::DeprecationWarning", "-c", code],
        check=False,
        capture_output=True,
        text=True,
        cwd=folder,
    )


@pytest.mark.parametrize(
    "code",
    [
        "from pushpressslide.studies.pusht.tee import FACES as old",
        "import pushpressslide.studies.pusht.tee as tee; old = tee.FACES",
        "from pushpressslide.studies.pusht import tee; old = tee.FACES",
        "from pushpressslide import studies; import pushpressslide.studies.pusht.tee; "
        "old = studies.pusht.tee.FACES",
    ],
)
def test_the_studies_warn_and_are_those_of_the_new_name(
    code: str, tmp_path: Path
) -> None:
    same = (
        "from pushpressslide_studies.pusht.tee import FACES as new; print(old is new)"
    )
    done = python(f"{code}; {same}", tmp_path)
    assert done.stdout == "True\n", done.stderr
    warning = "DeprecationWarning: pushpressslide.studies is pushpressslide_studies now"
    assert done.stderr.count(warning) == 1
    assert "<string>:1:" in done.stderr


def test_without_the_studies_their_old_name_says_what_to_install(
    tmp_path: Path,
) -> None:
    code = (
        "import sys; sys.modules['pushpressslide_studies'] = None\n"
        "try:\n    import pushpressslide.studies\n"
        "except ImportError as error:\n    print(error)"
    )
    done = python(code, tmp_path)
    (line,) = done.stdout.splitlines()
    assert line.endswith("not installed; pip install pushpressslide-studies")
    assert done.stderr == ""
