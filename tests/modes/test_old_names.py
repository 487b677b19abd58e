"""A user's mode written for version 0.4."""

import pytest

from pushpressslide.modes.rear_push import RearPush


def test_methods_answer_by_their_old_names_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="Mine.again: call it retry"):

        class Mine(RearPush):
            def again(self, query, segment, measured):
                return ("mine",)

    assert Mine().retry(None, None, None) == ("mine",)
    assert RearPush().retry(None, None, None) == ()  # type: ignore[arg-type]
