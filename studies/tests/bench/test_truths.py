"""Samples of one plan, on arrays and by the run loop."""

from pushpressslide.batch.fast import installed
from pushpressslide_studies.bench import truths


def test_each_way_is_timed_for_a_sample(monkeypatch):
    monkeypatch.setattr(truths, "SAMPLES", 5)
    monkeypatch.setattr(truths, "LOOPS", 1)
    monkeypatch.setattr(truths, "ROUNDS", 1)
    rows = {row["what"]: row for row in truths.truths(0)}
    assert list(rows) == ["batch, compiled", "run loop, planar engine"]
    if installed() is None:
        assert "fast" in rows.pop("batch, compiled")["note"]
    for row in rows.values():
        assert row["median_us"] > 0.0
        assert row["samples_s"] > 0.0
