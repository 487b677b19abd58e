"""Sweeps in the worlds of tiers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.jobs import sample as module
from pushpressslide.jobs.sample import run_forced, run_sample, sample_seed, sample_task
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.jobs.tiers import TIERS
from pushpressslide.taskfile.load import load_task

TASK = load_task("rear-push-left")
KINDS: tuple[dict[str, Any], ...] = (
    {"vary": "truth"},
    {"vary": "start"},
    {"vary": "tasks"},
    {"vary": "tasks", "draw": "any"},
)


def options(world: Any, **changes: Any) -> SweepOptions:
    return replace(SweepOptions(4, engine="planar", world=world, seed=3), **changes)


@pytest.mark.parametrize("kind", KINDS)
def test_tiers_have_the_same_tasks(kind: dict[str, Any]) -> None:
    for index in range(3):
        tasks = []
        seeds = set()
        for tier in TIERS:
            sample = sample_task(TASK, options(tier, **kind), index)
            assert sample.truth == Truth(tier=tier)
            seeds.add(sample_seed(sample, options(tier, **kind), index))
            tasks.append(replace(sample, truth=EXACT))
        assert tasks[0] == tasks[1] == tasks[2]
        assert len(seeds) == 1


def test_the_task_itself_is_only_renamed() -> None:
    sample = sample_task(TASK, options("tier2"), 1)
    assert replace(sample, name=TASK.name, truth=TASK.truth) == TASK


def test_each_sample_of_a_tier_has_a_seed_of_its_own_and_others_share_one() -> None:
    at_tier = options("tier1")
    samples = [sample_task(TASK, at_tier, index) for index in range(9)]
    seeds = [sample_seed(one, at_tier, i) for i, one in enumerate(samples)]
    assert len(set(seeds)) == 9
    assert sample_seed(TASK, options("known"), 5) == 3


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Task, int]]:
    """Tasks and seeds that reach the engine, which then gives up."""
    out: list[tuple[Task, int]] = []

    def simulate(task: Task, *, engine: str, seed: int) -> None:
        out.append((task, seed))
        raise RuntimeError("enough")

    monkeypatch.setattr(module, "simulate", simulate)
    return out


def test_samples_run_in_worlds_of_their_own_and_rows_say_which(
    drawn: list[tuple[Task, int]],
) -> None:
    rows = [run_sample(TASK, options("tier2"), index) for index in range(3)]
    assert [row["tier"] for row in rows] == ["tier2"] * 3
    assert [row["seed"] for row in rows] == [seed for _, seed in drawn]
    frictions = {task.belief.support_friction for task, _ in drawn}
    assert len(frictions) == 3
    assert all(task.support == TASK.support for task, _ in drawn)
    assert "tier" not in run_sample(TASK, options("known"), 0)


def test_a_refused_sample_is_run_in_the_same_world(
    drawn: list[tuple[Task, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    forced: list[Task] = []

    def choices(task: Task, count: int) -> list[Any]:
        forced.append(task)
        return []

    monkeypatch.setattr(module, "forced_choices", choices)
    run_sample(TASK, options("tier3"), 1)
    assert run_forced(TASK, options("tier3"), 1, 0)["tier"] == "tier3"
    assert forced[0].belief == drawn[0][0].belief
    assert forced[0].sensing == drawn[0][0].sensing


def test_batches_have_no_tiers(tmp_path: Path) -> None:
    with pytest.raises(PushPressSlideError, match="--world: 'tier1' is not allowed"):
        sweep(TASK, options("tier1", batched=True), tmp_path)


@pytest.mark.parametrize("vary", ["truth", "start", "knocks"])
def test_only_new_tasks_are_uncertain(tmp_path: Path, vary: Any) -> None:
    said = f"--world: 'uncertain' is not allowed with --vary {vary}; allowed: with --vary tasks"
    drake = options("uncertain", vary=vary, engine="drake")
    with pytest.raises(PushPressSlideError, match=said):
        sweep(TASK, drake, tmp_path)


def test_a_tier_leaves_the_rest_of_the_truth() -> None:
    task = replace(TASK, truth=Truth(tilt=0.01))
    sample = sample_task(task, options("tier3"), 0)
    assert sample.truth == Truth(tilt=0.01, tier="tier3")


@pytest.mark.long
def test_a_sweep_counts_what_is_true_beside_the_bias(tmp_path: Path) -> None:
    summary = sweep(TASK, options("tier2", samples=2, jobs=1), tmp_path)
    assert summary["world"] == "tier2"
    assert summary["reached"] == 2
