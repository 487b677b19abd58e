"""Batches compared with a copy of their bytes and with row-by-row alternatives."""

import numpy as np
import pytest

from pushpressslide.batch import fast
from pushpressslide_studies.bench import batches, compared


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(compared, "ROUNDS", 1)
    monkeypatch.setattr(batches, "SIZES", (500,))
    monkeypatch.setattr(batches, "ROUND", 500)
    monkeypatch.setattr(batches, "ALONE", 5)
    monkeypatch.setattr(batches, "PATHS", 20)


def test_each_law_stands_beside_a_copy_and_a_missing_compiler_is_said(monkeypatch):
    monkeypatch.setattr(batches, "installed", lambda: None)
    rows = batches.batches(1)
    assert len(rows) == 18
    for row in rows:
        assert row["rows"] == 500
        assert row["ratio"] > 0.0
        assert row["python_over"] == pytest.approx(1.0)  # it stands in for the compiler
        assert "pushpressslide[fast]" in row["note"]
    alone = {row["what"]: row["one_by_one_over"] for row in rows}
    assert alone.pop("holonomic law") is None
    assert all(value > 0.0 for value in alone.values())


def test_a_short_batch_is_called_several_times_a_round(monkeypatch):
    monkeypatch.setattr(batches, "ROUND", 2_500)
    seen = []

    def seen_and_compared(calls, counts):
        seen.append({name: len(some) for name, some in calls.items()})
        return compared.compared(calls, counts)

    monkeypatch.setattr(batches, "compared", seen_and_compared)
    monkeypatch.setattr(batches, "installed", lambda: fast)
    law = next(batches.allocators(np.random.default_rng(0), 500))
    batches._row(law, law, 500)
    assert seen == [{"copy": 5, "compiled": 5, "Python": 1, "one by one": 1}]


def test_a_batch_of_dubins_paths_stands_beside_ompl(monkeypatch):
    monkeypatch.setattr(batches, "installed", lambda: None)
    pytest.importorskip("ompl.base")
    rows = {row["what"]: row for row in batches.dubins(0)}
    assert rows["batch, Python"]["ratio"] == 1.0  # the first that is there
    assert rows["OMPL, one by one"]["median_us"] > 0.0
    assert np.isfinite(rows["one by one"]["ratio"])
