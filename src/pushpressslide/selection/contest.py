"""Reasons for the chosen mode: the chosen placement compared with the best placement of
every other mode.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core.plan import Choice, Plan
from pushpressslide.selection.select import contact_squeeze


@dataclass(frozen=True, slots=True)
class Contest:
    """The choice that a plan took for one placement, and its rivals."""

    winner: Choice
    # the best of every other mode, in the order of ranking, refused ones last
    rivals: tuple[Choice, ...]

    @property
    def sentence(self) -> str:
        """One line that explains why the winner was taken. Times are the estimates of
        the selection.
        """
        mode = self.winner.mode
        if not self.winner.feasible:
            return f"{mode} was asked for, although it is refused: {self.winner.reason}"
        if not self.rivals:
            return f"{mode} is the only mode that the task allows."
        feasible = [rival for rival in self.rivals if rival.feasible]
        if not feasible:
            if all(rival.evaluated for rival in self.rivals):
                return f"{mode} is taken: no other mode can do the task."
            return f"{mode} is taken: no other mode was found to do the task."
        count = f"{len(feasible) + 1} modes that can do the task"
        time = _seconds(self.winner)
        lead = self.lead(feasible[0])
        if lead is None or lead <= 0.0:
            text = f"{mode} is taken of {count}: as quick as {feasible[0].mode}, {time}"
            if contact_squeeze(self.winner) < contact_squeeze(feasible[0]):
                text += ", and its contacts push less against each other"
            return f"{text}."
        return (
            f"{mode} is taken: of {count} it is the quickest, {time} expected "
            f"with approach and release; {feasible[0].mode} follows with "
            f"{_seconds(feasible[0])}."
        )

    def lead(self, rival: Choice) -> float | None:
        """Time [s] by which a rival is slower. None if either time is unknown."""
        if self.winner.time is None or rival.time is None:
            return None
        return round(rival.time - self.winner.time, 3)

    def verdict(self, rival: Choice) -> str:
        """Reason in a few words why a rival was not taken."""
        if not rival.feasible:
            return f"{rival.verdict}: {rival.reason}"
        lead = self.lead(rival)
        if lead is None or lead <= 0.0:
            return "as quick"
        return f"{lead:.1f} s slower"


def contests(plan: Plan, choices: Sequence[Choice]) -> list[Contest]:
    """One contest for each choice that ``plan`` took from ``choices``, the ranked
    choices of its task.

    Empty if the motions were found by a search.
    """
    found = []
    ranked = sorted(choices, key=lambda choice: choice.verdict == "refused")
    for winner in plan.chosen(choices):
        best: dict[str, Choice] = {}
        for choice in ranked:
            if choice.leg == winner.leg and choice.mode != winner.mode:
                best.setdefault(choice.mode, choice)
        found.append(Contest(winner, tuple(best.values())))
    return found


def _seconds(choice: Choice) -> str:
    return "unknown time" if choice.time is None else f"{choice.time:.1f} s"
