"""A goal out of reach: its refusal names a base from which it is reached."""

import re

import pytest

import pushpressslide as pps


@pytest.mark.parametrize(
    ("name", "sets"),
    [
        ("rear-push-rear", ["robots.0.base={x: -0.6, y: 0.0}"]),
        ("press-slide", ["robots.0.base={x: 0.3, y: 1.3}"]),
    ],
)
def test_the_base_that_a_refusal_names_reaches_the_goal(
    name: str, sets: list[str]
) -> None:
    with pytest.raises(pps.TaskError, match=r"short of the object") as caught:
        pps.load_task(name, sets)
    found = re.search(
        r"robots\.0\.base at x (\S+), y (\S+) it reaches", str(caught.value)
    )
    assert found is not None
    x, y = found.groups()
    assert pps.load_task(name, [f"robots.0.base={{x: {x}, y: {y}}}"])


def test_no_base_is_named_where_none_reaches_start_and_goal() -> None:
    with pytest.raises(pps.TaskError, match=r"short of the object$"):
        pps.load_task("rear-push-rear", ["goal.x=4"])
