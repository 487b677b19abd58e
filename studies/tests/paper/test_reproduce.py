"""The paper's experiments are lists of tasks, and all their results are on one page."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper import experiments, reproduce
from pushpressslide_studies.paper.evidence import Evidence, Outcome
from pushpressslide_studies.paper.execution import FixedTarget
from pushpressslide_studies.paper.experiment import Experiment, Variant
from pushpressslide_studies.paper.experiments import AXLE, EXPERIMENTS, chosen
from pushpressslide_studies.paper.figures import FIGURES
from pushpressslide_studies.paper.one_arm import JOINT_TRACKING
from pushpressslide_studies.paper.table import outcome_lines

VARIANTS = [(e.name, v) for e in EXPERIMENTS.values() for v in e.variants]


@pytest.mark.parametrize(
    ("name", "variant"), VARIANTS, ids=[f"{n}-{v.name}" for n, v in VARIANTS]
)
def test_every_variant_is_a_shipped_task_with_overrides_that_load(
    name: str, variant: Variant
) -> None:
    load_task(variant.task, variant.settings)
    assert set(variant.paper) <= {row.key for row in FIGURES}


@pytest.mark.parametrize("experiment", EXPERIMENTS.values(), ids=lambda e: e.name)
def test_names_are_unique_and_what_is_compared_or_shown_is_a_variant(
    experiment: Experiment,
) -> None:
    names = [variant.name for variant in experiment.variants]
    assert len(set(names)) == len(names)
    for comparison in experiment.comparisons:
        assert {comparison.base, comparison.changed} <= set(names)
    assert {*experiment.pictured, *(experiment.plotted or ()), experiment.axle} <= {
        *names,
        "",
    }
    assert experiment.pictured


def test_the_variants_of_joint_tracking_differ_in_the_controller_alone() -> None:
    tasks = [
        load_task(variant.task, variant.settings) for variant in JOINT_TRACKING.variants
    ]
    first = tasks[0]
    for task in tasks[1:]:
        assert replace(task, motion=first.motion, limits=first.limits) == first
    variants = JOINT_TRACKING.variants
    ways = {(v.overrides, v.execution) for v in variants}
    assert len(ways) == len(variants)


def test_another_tracker_is_a_change_of_its_own() -> None:
    assert FixedTarget().changed == repr(FixedTarget())


def test_all_are_chosen_by_default_and_each_but_once() -> None:
    assert chosen(None) == (tuple(EXPERIMENTS.values()), True)
    assert chosen(["tool-use", "tool-use"]) == ((EXPERIMENTS["tool-use"],), False)
    assert chosen([AXLE]) == ((), True)


def test_an_unknown_experiment_is_refused_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(
        PushPressSlideError,
        match=r"--only: 'press' is not an experiment; allowed: rear-push, .*virtual-axle",
    ):
        reproduce.reproduce(["press"], out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def made_up(time: float, success: bool = True) -> dict[str, object]:
    figures = {row.key: time for row in FIGURES}
    return {
        **figures,
        "success": success,
        "reason": {"code": "time_limit", "text": "time is over"},
    }


def test_findings_say_what_a_change_did_and_where_it_ended() -> None:
    outcomes = {
        (JOINT_TRACKING.name, variant.name): Outcome(Path(), made_up(40.0))
        for variant in JOINT_TRACKING.variants
    }
    outcomes[JOINT_TRACKING.name, "servo"] = Outcome(Path(), made_up(10.0))
    outcomes[JOINT_TRACKING.name, "less-joint"] = Outcome(
        Path(), made_up(41.0, success=False)
    )
    slow, _, _, fast, worse = outcome_lines(JOINT_TRACKING, Evidence(outcomes))
    assert "Time 40.0 to 41.0 s (alike)" in slow
    assert slow.endswith("It ends with: time is over.")
    assert "Time 40.0 to 10.0 s (× 0.25)" in fast
    assert "Time 10.0 to 40.0 s (× 4.00)" in worse


def test_findings_are_silent_about_what_could_not_be_run() -> None:
    outcomes = {
        (JOINT_TRACKING.name, variant.name): Outcome(Path(), None, "no")
        for variant in JOINT_TRACKING.variants
    }
    assert outcome_lines(JOINT_TRACKING, Evidence(outcomes)) == []


def test_one_page_holds_runs_that_reach_miss_and_cannot_be_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    variants = (
        replace(EXPERIMENTS["rear-push"].variants[0], name="reached"),
        Variant(
            "missed", "Hard to please", "rear-push-rear", ("tolerance.position=1e-5",)
        ),
        Variant(
            "refused", "Not possible", "rear-push-rear", ("contact.friction=0.01",)
        ),
    )
    experiment = replace(
        EXPERIMENTS["rear-push"],
        name="mixed",
        variants=variants,
        pictured=("reached", "refused"),
    )
    monkeypatch.setitem(experiments.EXPERIMENTS, "mixed", experiment)
    seen: list[tuple[int, int]] = []
    page = reproduce.reproduce(
        ["mixed", AXLE],
        out=tmp_path,
        engine="planar",
        progress=lambda done, total: seen.append((done, total)),
    )
    assert page == tmp_path / "report.html"
    assert seen == [(1, 3), (2, 3), (3, 3)]
    text = page.read_text("utf-8")
    assert "≤ 15.0 mm" in text
    for file in ("replay.html", "report.html"):
        assert f'href="mixed/reached/{file}"' in text
        assert (tmp_path / "mixed" / "reached" / file).is_file()
    assert "goal missed" in text
    assert "not run: " in text
    assert "0.82 m" in text  # of the corrections
    assert text.count("data:image/png") == 2  # one picture, one plot
    for target in re.findall(r'(?:href|src)="([^"]+)"', text):
        assert target.startswith(("#", "data:", "mixed/")), (
            "self-contained, links relative"
        )
    result = json.loads((tmp_path / "result.json").read_text("utf-8"))
    reached, missed, refused = result["experiments"]["mixed"]["variants"]
    assert reached["measured"]["success"]
    assert reached["paper"]["final_position_error"] == 0.015
    assert missed["measured"]["reason"]["code"] == "goal_missed"
    assert refused["measured"] is None
    assert refused["failure"]
    judged = {claim["words"]: claim["verdict"] for claim in result["claims"]}
    (figure,) = (c for c in result["claims"] if c["figure"])
    assert figure["verdict"] == "reproduced"
    goals = "Every run: the goal is reached"
    assert judged[goals] == "not reproduced"
    assert len(result["corrections"]) == 15
    assert "| paper |" in (tmp_path / "table.md").read_text("utf-8")


@pytest.mark.long
def test_joint_term_and_servo_make_up_for_too_little_force(tmp_path: Path) -> None:
    """Three per cent below friction the force alone takes more than three times as long
    as with the term or the servo.
    """
    measured = {}
    for variant in JOINT_TRACKING.variants:
        if variant.name in ("less", "less-joint", "servo"):
            # it creeps on: longer than that is slow enough
            most = (*variant.overrides, "limits.time=120")
            stopped = replace(variant, overrides=most)
            measured[variant.name] = reproduce.run_variant(
                JOINT_TRACKING, stopped, tmp_path / variant.name, 0, "drake"
            ).result
    less, joined, servo = (measured[name] for name in ("less", "less-joint", "servo"))
    assert less["motion_duration"] > 100.0
    assert joined["success"]
    assert joined["motion_duration"] < 0.3 * less["motion_duration"]
    assert servo["success"]
    assert servo["motion_duration"] < 0.3 * less["motion_duration"]
    for key in ("rms_position_error", "rms_end_effector_error", "rms_yaw_error"):
        assert servo[key] < 0.2 * less[key]


def test_an_unknown_engine_is_refused_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(
        PushPressSlideError,
        match="engine: 'plana' is not allowed; did you mean 'planar'",
    ):
        reproduce.reproduce(["rear-push"], out=tmp_path / "out", engine="plana")
    assert not (tmp_path / "out").exists()
