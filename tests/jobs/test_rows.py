"""Rows of a sweep are whole lines, even if their writer is killed."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pushpressslide.core.errors import WriteError
from pushpressslide.jobs import rows
from pushpressslide.jobs.rows import Row, Rows


def row(index: int) -> Row:
    return {"index": index, "status": "reached", "reason": "x" * 3000}


def indices(path: Path, count: int) -> list[int]:
    again = Rows(path, "key")
    return [index for index in range(count) if index in again]


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(1, 6000))
def test_a_line_that_was_cut_off_spoils_none_after_it(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "rows.jsonl"
    path.unlink(missing_ok=True)
    Rows(path, "key").extend([row(0), row(1)])
    size = path.stat().st_size
    os.truncate(path, size - cut)
    whole = indices(path, 2)
    resumed = Rows(path, "key")
    resumed.add(row(2))
    assert indices(path, 3) == [*whole, 2]
    assert list(resumed.read(0)) == []
    assert path.read_bytes().endswith(b"\n")


def test_a_full_disk_leaves_the_rows_before_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(file: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "rows.jsonl"
    kept = Rows(path, "key")
    kept.add(row(0))
    before = path.read_bytes()
    monkeypatch.setattr(rows.os, "fsync", fail)
    with pytest.raises(WriteError, match="No space left"):
        kept.extend([row(1), row(2)])
    assert path.read_bytes() == before
    assert 1 not in kept
