"""Runs with other memory allocators."""

from pathlib import Path

import pytest

from pushpressslide_studies.bench import memory
from pushpressslide_studies.bench.bench import BENCHMARKS


def test_an_allocator_that_is_not_there_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(memory, "find_library", lambda name: None)
    assert memory._run_with("jemalloc") == "not found: libjemalloc"


@pytest.mark.long
def test_the_motion_is_the_same_to_the_bit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(memory, "ROUNDS", 1)
    rows = BENCHMARKS["memory"](0, tmp_path)
    assert [row["what"] for row in rows] == ["the C library's", *memory.ALLOCATORS]
    first, *others = rows
    assert first["ratio"] == 1.0
    for row in others:
        if row["median_us"] is None:
            assert row["note"].startswith("not found: lib")
        else:
            assert (row["x_mm"], row["y_mm"]) == (first["x_mm"], first["y_mm"])
