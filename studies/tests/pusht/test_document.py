"""The page on push-T shows the output of the command."""

import json
from pathlib import Path

from pushpressslide_studies.pusht.benchmark import figures_of
from pushpressslide_studies.pusht.game import Episode
from pushpressslide_studies.pusht.published import PUBLISHED

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "gym-pusht.md").read_text(encoding="utf-8")


def test_the_page_shows_the_figures_of_its_rows() -> None:
    lines = (DOCS / "data" / "gym-pusht.jsonl").read_text().splitlines()
    rows = [Episode(**json.loads(line)) for line in lines]
    assert [row.seed for row in rows] == list(range(3000, 3500))
    figures = figures_of(rows)
    low, high = figures.success_interval
    cells = (
        "pushpressslide, seeds 3000 to 3499",
        "state",
        str(figures.episodes),
        f"{100.0 * figures.success:.1f} %",
        f"{100.0 * low:.1f} to {100.0 * high:.1f} %",
        f"{figures.reward:.3f}",
        f"{figures.overlap:.3f}",
        f"{figures.steps:.1f}",
    )
    assert f"| {' | '.join(cells)} |" in PAGE


def test_the_page_shows_the_published_figures() -> None:
    for row in PUBLISHED:
        shown = f"| {row.episodes} | {100.0 * row.success:.1f} % | | {row.reward:.3f} |"
        assert shown in PAGE
