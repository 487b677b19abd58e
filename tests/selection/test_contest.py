"""The sentence on why a mode was taken is true of the choices considered."""

from collections.abc import Callable
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.selection.contest import Contest, contests
from pushpressslide.selection.select import select

Shipped = Callable[[str], Plan]


def choice(mode: str, time: float | None, *normals: tuple[float, float]) -> Choice:
    contacts = tuple(Contact(0, "side", (0.0, 0.0), n, 0.05) for n in normals)
    return Choice(mode, "here", contacts, time=time)


BEST = choice("press_slide", 10.0)
SLOWER = choice("rear_push", 11.26)
REFUSED = replace(SLOWER, refusal=Refusal("tips", "it tips"))


def test_the_quickest_names_its_time_the_next_and_how_many_there_were() -> None:
    contest = Contest(BEST, (SLOWER, choice("parallel_push", 12.0), REFUSED))
    assert contest.sentence == (
        "press_slide is taken: of 3 modes that can do the task it is the quickest, "
        "10.0 s expected with approach and release; rear_push follows with 11.3 s."
    )
    assert contest.verdict(SLOWER) == "1.3 s slower"
    assert contest.verdict(REFUSED) == "refused: here: it tips"


def test_a_mode_that_alone_can_or_alone_may_says_so() -> None:
    assert Contest(BEST, ()).sentence.endswith("is the only mode that the task allows.")
    assert Contest(BEST, (REFUSED,)).sentence.endswith("no other mode can do the task.")


def test_a_mode_that_was_not_evaluated_is_skipped_and_not_refused() -> None:
    skipped = replace(SLOWER, refusal=Refusal(SKIPPED, "not evaluated: 24 are blocked"))
    contest = Contest(BEST, (skipped,))
    assert contest.verdict(skipped) == "skipped: here: not evaluated: 24 are blocked"
    assert contest.sentence.endswith("no other mode was found to do the task.")


def test_a_mode_with_skipped_and_refused_choices_is_not_excluded() -> None:
    """Though the refused one would be quicker."""
    path = pps.plan(pps.load_task("press-slide"))
    (winner,) = path.chosen(select(path.task))
    skipped = replace(SLOWER, refusal=Refusal(SKIPPED, "not evaluated"), time=20.0)
    quicker = replace(REFUSED, time=5.0)
    (contest,) = contests(path, [winner, quicker, skipped])
    assert contest.rivals == (skipped,)


def test_of_equally_quick_modes_the_contacts_decide_and_the_sentence_says_so() -> None:
    ahead = choice("parallel_push", 10.0, (1.0, 0.0), (1.0, 0.0))
    across = choice("orthogonal_push", 10.0, (1.0, 0.0), (0.0, 1.0))
    assert "as quick as orthogonal_push, 10.0 s, and its contacts push less" in (
        Contest(ahead, (across,)).sentence
    )
    assert "contacts" not in Contest(across, (ahead,)).sentence
    assert Contest(ahead, (across,)).verdict(across) == "as quick"


def test_a_mode_that_was_forced_is_not_praised() -> None:
    contest = Contest(REFUSED, (BEST,))
    assert contest.sentence == (
        "rear_push was asked for, although it is refused: here: it tips"
    )


@pytest.mark.parametrize("name", ["any-mode", "rear-push-rear", "tool-use"])
def test_the_contests_of_a_plan_hold_each_mode_once(
    shipped_plan: Shipped, name: str
) -> None:
    plan = shipped_plan(name)
    choices = select(pps.load_task(name))
    found = contests(plan, choices)
    assert [contest.winner for contest in found] == plan.chosen(choices)
    for contest in found:
        modes = [contest.winner.mode, *(rival.mode for rival in contest.rivals)]
        of_leg = {c.mode for c in choices if c.leg == contest.winner.leg}
        assert sorted(modes) == sorted(of_leg)


def test_motions_that_a_search_found_have_no_contest(shipped_plan: Shipped) -> None:
    plan = shipped_plan("carton")
    assert len(plan.placements) > 1
    assert contests(plan, select(pps.load_task("carton"))) == []


def test_in_any_mode_several_modes_compete_and_the_taken_one_is_there_first(
    shipped_plan: Shipped,
) -> None:
    """What the demo shows: the estimate agrees with runs of every mode."""
    task = pps.load_task("any-mode")
    (contest,) = contests(shipped_plan("any-mode"), select(task))
    able = [rival for rival in contest.rivals if rival.feasible]
    assert len(able) >= 4
    assert all((contest.lead(rival) or 0.0) > 0.5 for rival in able)
    taken, *others = (_run_time(task, one) for one in (contest.winner, *able))
    assert taken < min(others)


def _run_time(task: pps.Task, one: Choice) -> float:
    plan = Plan(task, one.segments)
    record = pps.run(plan, engine="planar")
    assert record.success
    return float(record.figures["duration"])
