"""Engines by name."""

import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.jobs.engines import DEFAULT, ENGINES, EngineName, engine_named


def test_every_name_of_the_command_line_has_its_engine() -> None:
    assert list(ENGINES) == list(EngineName)
    assert DEFAULT in ENGINES


def test_an_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(
        PushPressSlideError, match="'bullet' is not allowed; allowed: "
    ) as e:
        engine_named("bullet")
    assert all(name in str(e.value) for name in ENGINES)


def test_an_engine_without_arms_takes_every_plan_without_joint_paths() -> None:
    for engine in ENGINES.values():
        if engine.has_arms:
            continue
        preparation = engine.preparation(force=False)
        preparation.add("plan")
        assert list(preparation.plans) == ["plan"]
        assert not preparation.paths
