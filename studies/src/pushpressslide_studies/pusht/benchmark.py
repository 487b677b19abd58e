"""Many episodes, and their results."""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path

from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.parallel import in_parallel
from pushpressslide.jobs.summary import interval
from pushpressslide.report.json_text import to_json
from pushpressslide.report.metrics import installed_versions
from pushpressslide_studies.pusht.game import Episode, open_game, play, play_seeds

Progress = Callable[[float, float], None]
PORTION = 5  # episodes that a process plays at a time
ROWS = "episodes.jsonl"


@dataclass(frozen=True, slots=True)
class Figures:
    """Figures of several episodes."""

    episodes: int
    successes: int
    success: float  # share
    success_interval: tuple[float, float]  # 95 %, Wilson
    reward: float  # mean of the episodes' greatest
    overlap: float  # mean of the episodes' greatest
    least_overlap: float  # the least of the episodes' greatest
    steps: float  # mean
    most_steps: int
    wall_time: float  # [s] mean
    failed: tuple[int, ...]  # seeds


def benchmark(
    seeds: range,
    out: Path,
    noise: float = 0.0,
    jobs: int = 1,
    progress: Progress | None = None,
) -> Figures:
    """Play an episode for each seed and return the figures of all episodes.

    It writes ``out``/episodes.jsonl, with one row per episode, and ``out``/result.json.
    ``noise`` [px] is as in ``game.play``; ``jobs`` is the number of processes. Raises
    PushPressSlideError if the package is not installed.
    """
    if jobs == 1:
        rows = _played_here(seeds, noise, progress)
    else:
        rows = _played(seeds, noise, jobs, progress)
    figures = figures_of(rows)
    # of an older run: a folder that has one is complete
    (out / "result.json").unlink(missing_ok=True)
    lines = (json.dumps(asdict(row)) + "\n" for row in rows)
    write_whole(out / ROWS, "".join(lines))
    result = {
        "schema": 1,
        "first_seed": seeds.start,
        "noise": noise,
        **asdict(figures),
        "versions": installed_versions() | _game_versions(),
    }
    write_whole(out / "result.json", to_json(result))
    return figures


def _game_versions() -> dict[str, str]:
    """Versions of the game's packages."""
    return {name: version(name) for name in ("gym-pusht", "pymunk")}


def _played_here(
    seeds: range, noise: float, progress: Progress | None
) -> list[Episode]:
    """Episodes of all seeds, played in this process."""
    game = open_game()
    rows = []
    for done, seed in enumerate(seeds, 1):
        rows.append(play(game, seed, noise))
        if progress is not None:
            progress(done, len(seeds))
    game.close()
    return rows


def _played(
    seeds: range, noise: float, jobs: int, progress: Progress | None
) -> list[Episode]:
    """Episodes of all seeds, played in several processes."""
    open_game().close()
    portions = [seeds[i : i + PORTION] for i in range(0, len(seeds), PORTION)]
    work = {portion.start: partial(play_seeds, portion, noise) for portion in portions}
    played = in_parallel(work, jobs, progress)
    return [episode for portion in played.values() for episode in portion]


def figures_of(rows: Sequence[Episode]) -> Figures:
    """Figures of one or more episodes. Raises ValueError if there are none."""
    count = len(rows)
    successes = sum(row.success for row in rows)
    bounds = interval(successes, count)
    if bounds is None:
        raise ValueError("0 episodes have no figures; at least 1 is needed")
    return Figures(
        episodes=count,
        successes=successes,
        success=successes / count,
        success_interval=bounds,
        reward=statistics.fmean(row.reward for row in rows),
        overlap=statistics.fmean(row.overlap for row in rows),
        least_overlap=min(row.overlap for row in rows),
        steps=statistics.fmean(row.steps for row in rows),
        most_steps=max(row.steps for row in rows),
        wall_time=statistics.fmean(row.wall_time for row in rows),
        failed=tuple(row.seed for row in rows if not row.success),
    )
