"""Pairs of wrench and motion: the conventions of the logs, from a synthetic session
with a known answer.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.pairs import measured_pairs
from pushpressslide.identification.push_sets import (
    PRISM,
    layout_note,
    load_sets,
    pins_of_name,
)
from pushpressslide.identification.recordings import read_recording
from pushpressslide.mechanics.pressure import pin_pressure
from pushpressslide.mechanics.rho import rho_pole

PINS = ((-0.02, -0.02), (0.04, -0.02), (-0.02, 0.04))
PINS_TRACKED = ((0.03, 0.03), (0.09, 0.03), (0.03, 0.09))
LAYOUT = "30_90_30_30_30_90"


@pytest.fixture(scope="module")
def session(sample_pairs, write_log):
    pairs = sample_pairs(pin_pressure(PINS, (0.0, 0.0), 14.715), 0.3, 20)
    return pairs, write_log(pairs)


def test_wrench_motion_contact_and_height_are_what_happened(
    tmp_path: Path, session
) -> None:
    pairs, text = session
    path = tmp_path / "log.txt"
    path.write_text(text)
    measured, refused = measured_pairs(
        read_recording(path).pushes, PRISM.center_of_mass
    )
    assert refused == []
    assert measured.wrenches == pytest.approx(pairs.wrenches, abs=2e-5)
    assert measured.twists == pytest.approx(pairs.twists, abs=1e-7)
    assert measured.contacts == pytest.approx(pairs.contacts, abs=1e-6)
    assert measured.heights == pytest.approx(np.full(20, 0.0125), abs=1e-6)
    assert np.linalg.norm(measured.directions, axis=1) == pytest.approx(np.ones(20))


def test_the_motion_does_not_depend_on_the_sign_of_a_quaternion(
    tmp_path: Path, session
) -> None:
    path = tmp_path / "log.txt"
    path.write_text(session[1])
    pushes = read_recording(path).pushes
    turned = [
        replace(p, after=p.after * np.array([1, 1, 1, -1, -1, -1, -1])) for p in pushes
    ]
    a, b = (
        measured_pairs(which, PRISM.center_of_mass)[0] for which in (pushes, turned)
    )
    assert b.twists == pytest.approx(a.twists, abs=1e-12)


def test_a_push_without_samples_force_or_motion_gives_no_pair_and_says_so(
    tmp_path: Path, session
) -> None:
    path = tmp_path / "log.txt"
    path.write_text(session[1])
    push, *rest = read_recording(path).pushes
    weak = push.forces * (1.0, 1e-3, 1e-3)
    broken = [
        replace(push, forces=push.forces[:0]),
        replace(push, probe=push.probe[:0]),
        replace(push, after=push.before),
        replace(push, forces=weak),
    ]
    pairs, refused = measured_pairs([*broken, *rest], PRISM.center_of_mass)
    assert len(pairs) == len(rest)
    assert refused == [
        "push 1: no force or probe samples",
        "push 2: no force or probe samples",
        "push 3: moved less than 1 mm",
        "push 4: force below 0.2 N",
    ]


def test_a_folder_names_its_pins() -> None:
    assert pins_of_name("30_63.33_43.33_30_43.33_63.33")[1] == pytest.approx(
        (0.06333, 0.04333)
    )
    for name in ("patch", "30_90_30", "a_b_c_d_e_f", "30_90_30_30_30"):
        assert pins_of_name(name) == ()


@pytest.mark.parametrize(
    ("name", "note"),
    [
        ("30_90_30_30_30_90", ""),
        ("wood_30_90_30_30_30_90", "assumed to be 30_90_30_30_30_90"),
        ("wood-30_90_30_30_30_90", "assumed to be 30_90_30_30_30_90"),
        ("30_90_30_30_30_90_mixed", "assumed to be 30_90_30_30_30_90"),
        ("08_17_30_90_30_30_30_90", "assumed to be 30_90_30_30_30_90"),
    ],
)
def test_pins_are_understood_beside_other_words_and_said(name: str, note: str) -> None:
    assert pins_of_name(name) == tuple(pytest.approx((x, y)) for x, y in PINS_TRACKED)
    assert note in layout_note(name)
    assert bool(note) == bool(layout_note(name))


def test_a_name_without_pins_is_warned_about_unless_it_says_patch() -> None:
    assert "whole base" in layout_note("wood_30_90_30")
    assert "whole base" in layout_note("pushes")
    assert layout_note("wood_patch") == ""


def test_logs_without_a_push_are_passed_over_by_name(tmp_path: Path, session) -> None:
    (tmp_path / "patch").mkdir()
    (tmp_path / "patch" / "a.txt").write_text(session[1])
    (tmp_path / "patch" / "cut.txt").write_text("50\n")
    (tmp_path / "patch" / "none.txt").write_text("")
    sets, passed_over = load_sets(tmp_path)
    assert [len(each.pairs) for each in sets] == [20]
    assert passed_over == [
        "none.txt: not a log of pushes.",
        "cut.txt: holds no push, announces 50.",
    ]
    (tmp_path / "patch" / "a.txt").unlink()
    with pytest.raises(PushPressSlideError, match="holds no push"):
        load_sets(tmp_path)


def test_each_folder_is_a_set_with_the_load_that_statics_gives(
    tmp_path: Path, session
) -> None:
    for name in (
        f"first/{LAYOUT}/a.txt",
        f"first/{LAYOUT}/b.txt",
        f"second/{LAYOUT}/a.txt",
        "second/face/a.txt",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(session[1])
    sets, passed_over = load_sets(tmp_path)
    assert [(s.name, len(s.pairs)) for s in sets] == [
        (f"first/{LAYOUT}", 40),
        (f"second/{LAYOUT}", 20),
        ("second/face", 20),
    ]
    assert passed_over == []
    assert sets[0].pins == tuple(pytest.approx(pin) for pin in PINS)
    assert sets[0].static_pressure().loads == pytest.approx([4.905] * 3)
    assert 1e3 * rho_pole(sets[0].static_pressure()) == pytest.approx(39.2, abs=0.1)
    assert sets[0].uniform_pressure() is None
    assert 1e3 * rho_pole(sets[2].uniform_pressure()) == pytest.approx(45.2, abs=0.1)
    assert sets[2].static_pressure().cop == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_set_that_cannot_be_used_is_refused(tmp_path: Path, session) -> None:
    (tmp_path / "10_20_30_10_10_10").mkdir()
    log = tmp_path / "10_20_30_10_10_10" / "log.txt"
    log.write_text(session[1])
    with pytest.raises(
        PushPressSlideError,
        match="cannot carry the object: the three pins are in one line",
    ):
        load_sets(tmp_path)
    log.write_text("1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n0\n0\n")
    with pytest.raises(
        PushPressSlideError,
        match=r"0 of 1 pushes can be used \(push 1: no force.*at least 4",
    ):
        load_sets(log)
