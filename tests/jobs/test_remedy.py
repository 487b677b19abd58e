"""The change that a refusal names: it is tried, small, and said by every command."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.jobs.remedy import MOST_TRIED, _Trial, remedy

CRATE = """name: crate
object: {shape: {box: [0.3, 0.3, 0.25]}, mass: 8.0}
support: {friction: 0.4}
start: {x: 0.5, y: -0.1}
goal: {x: 0.62, y: -0.1}
modes: [rear_push]
robots: [{model: panda}]
limits: {normal_force: 20}
"""


def refused(task: pps.Task) -> pps.InfeasibleTaskError:
    with pytest.raises(pps.InfeasibleTaskError) as caught:
        pps.plan(task)
    return caught.value


@pytest.fixture
def crate(tmp_path) -> pps.Task:
    path = tmp_path / "crate.yaml"
    path.write_text(CRATE)
    return pps.load_task(str(path))


def test_a_force_that_lacks_is_named_with_the_mode_that_then_can(crate) -> None:
    error = refused(crate)
    assert error.brief.endswith(
        "; raise limits.normal_force to 36 N to make rear_push feasible"
    )
    assert str(error).endswith("to make rear_push feasible")
    enough = replace(crate, limits=replace(crate.limits, normal_force=36.0))
    assert pps.plan(enough).segments
    less = replace(crate, limits=replace(crate.limits, normal_force=34.0))
    assert "raise limits.normal_force" in refused(less).brief


@pytest.mark.parametrize(
    ("name", "sets", "text"),
    [
        ("rear-push-rear", ["limits.time=10"], "raise limits.time to"),
        (
            "rear-push-rear",
            ["robots.0.base={x: -0.35, y: 0}"],
            "move robots.0.base to {x: -0.25",
        ),
        (
            "rear-push-rear",
            ["motion.contact_height=0.14", "support.friction=0.6"],
            "leave motion.contact_height out",
        ),
        ("press-slide", ["contact.friction=0.28"], "raise contact.friction"),
        ("post", ["motion.clearance=0.1", "limits.legs=1"], "lower motion.clearance"),
        (
            "rear-push-rear",
            [
                "object.shape={box: [0.02, 0.02, 0.012]}",
                "object.mass=0.1",
                "modes=null",
            ],
            "lower robots.0.tip_radius",
        ),
    ],
)
def test_the_field_that_lifts_a_refusal_is_named(name, sets, text) -> None:
    assert text in refused(pps.load_task(name, sets)).brief


def test_few_changes_are_tried(crate, monkeypatch) -> None:
    tried = []
    monkeypatch.setattr(_Trial, "mode", lambda self, *change: tried.append(change))
    trial = _Trial(crate)
    error = refused(crate)
    assert trial.left == MOST_TRIED
    assert remedy(crate, error.choices) is None


def test_missing_joint_paths_alone_name_no_change(crate) -> None:
    assert remedy(crate, ()) is None
