"""``pps gym-pusht``."""

import sys
from pathlib import Path

import pytest

from pushpressslide.cli.app import app
from pushpressslide_studies.cli.pusht_table import print_figures
from pushpressslide_studies.pusht.benchmark import figures_of
from pushpressslide_studies.pusht.game import Episode


def status_of(*words: str) -> int:
    return int(app(list(words), standalone_mode=False))


def test_a_missing_package_is_one_clear_line(monkeypatch, capsys, tmp_path) -> None:
    monkeypatch.setitem(sys.modules, "gym_pusht", None)
    folder = str(tmp_path / "out")
    assert status_of("gym-pusht", "--episodes", "1", "--out", folder) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "pip install 'pushpressslide-studies[pusht]'" in line
    assert not Path(folder).exists()


def test_a_film_of_another_kind_is_refused_before_anything_is_played(capsys) -> None:
    assert status_of("gym-pusht", "--episodes", "1", "--video", "film.avi") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert ".webp or .gif" in line


def test_the_table_names_what_failed_and_fits_80_columns(capsys) -> None:
    rows = [
        Episode(7, 40, 0.99, 1.0, True, 1, 0.1),
        Episode(8, 300, 0.6, 0.63, False, 9, 2.0),
    ]
    print_figures(figures_of(rows))
    text = capsys.readouterr().out
    assert "50.0%" in text
    assert "…" not in text
    assert "Seeds that failed: 8." in text
    assert max(map(len, text.splitlines())) <= 80


def test_no_episodes_have_no_figures() -> None:
    with pytest.raises(ValueError, match="0 episodes"):
        figures_of([])
