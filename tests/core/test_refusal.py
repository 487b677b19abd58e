"""Refusals as data, and the texts made from them."""

import math

import pytest

from pushpressslide.core.refusal import (
    SHOWN,
    Quantity,
    Refusal,
    RefusedError,
    literal,
    refusal_of,
)

RENDERED = [
    ("mm.1f", 0.0412, "41.2 mm"),
    ("mmg", 0.005, "5 mm"),
    ("m.2f", 1.234, "1.23 m"),
    ("mg", 0.5, "0.5 m"),
    ("deg.0f", -0.5 * math.pi, "-90 deg"),
    ("degg", math.radians(3.0), "3 deg"),
    ("N.1f", 19.62, "19.6 N"),
    ("s.0f", 61.4, "61 s"),
    (".2f", 0.957, "0.96"),
    ("g", 0.4, "0.4"),
]


@pytest.mark.parametrize(("form", "number", "words"), RENDERED)
def test_a_number_is_shown_in_the_unit_that_its_format_names(
    form: str, number: float, words: str
) -> None:
    assert format(Quantity(number), form) == words
    text = f"it is {{figure:{form}}}, allowed {{allowed:{form}}}"
    assert str(Refusal("x", text, number, number)) == f"it is {words}, allowed {words}"


def test_every_unit_is_shown_above() -> None:
    units = {words.partition(" ")[2] for _, _, words in RENDERED}
    assert units == set(SHOWN)


def test_a_refusal_without_figures_says_its_text() -> None:
    refusal = Refusal("no_path", "no path")
    assert str(refusal) == "no path"
    assert (refusal.figure, refusal.allowed, refusal.unit) == (None, None, "")


def test_a_figure_that_is_not_there_is_never_invented() -> None:
    refusal = Refusal("x", "at {figure:mm.0f}, allowed {allowed:.1f}", math.nan)
    assert str(refusal) == "at unknown, allowed unknown"


@pytest.mark.parametrize("text", ["obstacle 'a{b}'", "{", "}}{{", "{figure:mm.0f}"])
def test_text_with_braces_is_said_as_it_is(text: str) -> None:
    refusal = Refusal("obstacle", f"{literal(text)} at {{figure:mm.0f}}", 0.012)
    assert str(refusal) == f"{text} at 12 mm"


def test_an_error_carries_its_refusal_and_says_it() -> None:
    refusal = Refusal("tipping", "a push at {figure:mm.0f} tips", 0.2, unit="m")
    error = RefusedError(refusal)
    assert isinstance(error, ValueError)
    assert str(error) == "a push at 200 mm tips"
    assert refusal_of(error, "other") is refusal


def test_any_other_error_is_refused_for_in_its_own_words() -> None:
    refusal = refusal_of(ValueError("rho {0} m; must be > 0"), "press")
    assert refusal.code == "press"
    assert str(refusal) == "rho {0} m; must be > 0"
