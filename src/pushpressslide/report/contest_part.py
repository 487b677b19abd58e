"""Why a run took its mode: a sentence, and a small table of the mode's rivals."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from pushpressslide.core.plan import Choice, Plan
from pushpressslide.report.page_tables import mode_words, table
from pushpressslide.selection.contest import Contest, contests

HEAD = ("Mode", "", "Expected time")


def contest_part(plan: Plan, choices: Sequence[Choice]) -> str:
    """Part of a page that explains the choice of each mode in a plan. Empty if the
    plan's motions were found by a search.
    """
    return "".join(_one(contest) for contest in contests(plan, choices))


def _one(contest: Contest) -> str:
    text = f"<p>{escape(contest.sentence)}</p>"
    if not contest.rivals:
        return text
    rows = [_row(contest.winner, "taken")]
    rows += [_row(rival, contest.verdict(rival)) for rival in contest.rivals]
    refused = ["" if r.feasible else ' class="refused"' for r in contest.rivals]
    return text + table(HEAD, rows, [' class="chosen"', *refused], numbers=1)


def _row(choice: Choice, verdict: str) -> list[str]:
    time = "–" if choice.time is None else f"{choice.time:.1f} s"
    return [
        f"<td>{mode_words(choice.mode)}</td>",
        f"<td class=why>{escape(verdict)}</td>",
        f"<td class=n>{time}</td>",
    ]
