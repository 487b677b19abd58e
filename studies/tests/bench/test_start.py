"""Programs with a timed start exist, and a failing one yields no figure."""

import subprocess

import pytest

from pushpressslide_studies.bench import compared, start


def test_each_program_stands_beside_numpy(monkeypatch):
    monkeypatch.setattr(compared, "ROUNDS", 1)
    monkeypatch.setattr(
        start,
        "PROGRAMS",
        {name: start.PROGRAMS[name] for name in ("import numpy", "pps --help")},
    )
    numpy, helped = start.start()
    assert numpy["ratio"] == 1.0
    assert helped["ratio"] > 0.0


def test_a_program_that_fails_is_an_error(monkeypatch):
    monkeypatch.setattr(start, "PROGRAMS", {"fails": ("-c", "raise SystemExit(3)")})
    with pytest.raises(subprocess.CalledProcessError):
        start.start()
