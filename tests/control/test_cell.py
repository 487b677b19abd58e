"""Cells: their arms are driven for as long as a run lasts."""

from dataclasses import dataclass, field
from typing import Any

import pytest

from pushpressslide.control.cell import Cell


@dataclass
class Arm:
    """An arm that writes down its calls."""

    name: str
    calls: list[str] = field(default_factory=list)
    broken: bool = False

    def connect(self) -> None:
        if self.broken:
            raise OSError(f"{self.name} does not answer")
        self.calls.append("connect")

    def disconnect(self) -> None:
        self.calls.append("disconnect")


def cell_with(*arms: Arm) -> Cell:
    nothing: Any = None
    driven: Any = list(arms)
    return Cell("cell", nothing, driven, nothing)


def test_arms_are_driven_until_the_end_even_after_an_error() -> None:
    arms = (Arm("left"), Arm("right"))
    with pytest.raises(ZeroDivisionError), cell_with(*arms).connected():
        raise ZeroDivisionError
    assert [arm.calls for arm in arms] == [["connect", "disconnect"]] * 2


def test_an_arm_that_does_not_answer_leaves_none_driven() -> None:
    left, right = Arm("left"), Arm("right", broken=True)
    with pytest.raises(OSError, match="right"), cell_with(left, right).connected():
        pass
    assert left.calls == ["connect", "disconnect"]
    assert right.calls == []
