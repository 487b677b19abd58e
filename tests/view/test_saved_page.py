"""A saved Meshcat page is packed, and drawings on a support stay on it."""

import base64
import gzip
import re

import numpy as np
import pytest

from pushpressslide.core.scene import Opening
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import Support
from pushpressslide.jobs.engines import ArmOptions, engine_named
from pushpressslide.view.drake import frames
from pushpressslide.view.drake.lines import grid_lines, ribbons
from pushpressslide.view.drake.saved_page import small_page

FETCH = """
fetch("data:application/octet-binary;base64,{}")
    .then(res => res.arrayBuffer())
    .then(buffer => viewer.handle_command_bytearray(new Uint8Array(buffer)));
"""


def saved(messages):
    calls = "".join(FETCH.format(base64.b64encode(m).decode()) for m in messages)
    return f"<html><head></head><body><script>{calls}</script></body></html>"


def test_the_messages_of_a_page_are_packed_in_their_order():
    messages = [b"one" * 500, b"", b"\\1 three"]
    page = small_page(saved(messages), "<meta>", "<p>bar</p>")
    assert "fetch(" not in page
    assert "<head><meta>" in page
    assert "<p>bar</p></body>" in page
    (text,) = re.findall(r'loadMessages\("([^"]*)"\);', page)
    data = gzip.decompress(base64.b64decode(text))
    found = []
    while data:
        size = int.from_bytes(data[:4], "little")
        found.append(data[4 : 4 + size])
        data = data[4 + size :]
    assert found == messages


def test_a_page_of_another_drake_keeps_its_messages():
    page = "<html><head></head><body><script>other()</script></body></html>"
    assert "other()" in small_page(page, "<meta>", "<p>bar</p>")
    assert "loadMessages" not in small_page(page, "<meta>", "<p>bar</p>")


def test_the_grid_has_a_line_every_tenth_of_a_metre():
    lines = grid_lines(Support(kind="incline", angle=0.1), (0.05, 0.15, 0.05, 0.15))
    upright = sorted({round(a[0], 6) for a, b in lines if a[0] == b[0]})
    assert np.diff(upright) == pytest.approx(0.1)
    assert (upright[0], upright[-1]) == (-0.2, 0.4)


def test_the_grid_ends_at_the_edges_of_a_table_and_leaves_an_opening_out():
    region = ((0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3))
    points = np.concatenate(grid_lines(Support(region=region), (0.1, 0.2, 0.1, 0.2)))
    assert points.min(axis=0) == pytest.approx([0.0, 0.0])
    assert points.max(axis=0) == pytest.approx([0.4, 0.3])
    wall = Support(
        kind="wall",
        frame=SupportFrame.of_wall((0.86, 0.0, 0.81), np.pi),
        opening=Opening((0.25, 0.15), (0.0, 0.0), 0.1),
    )
    middles = np.mean(grid_lines(wall, (-0.1, 0.1, -0.1, 0.1)), axis=1)
    inside = np.all(np.abs(middles) < (0.125, 0.075), axis=1)
    assert not inside.any()


def test_strips_of_one_mesh_have_faces_of_their_own():
    lines = [np.array([[0.0, y], [1.0, y]]) for y in (0.0, 1.0)]
    text = ribbons(lines, 0.01).source().in_memory().mesh_file.contents().decode()
    faces = [line.split()[1:] for line in text.splitlines() if line.startswith("f ")]
    first, second = (
        {int(v.split("//")[0]) for f in faces[i : i + 2] for v in f} for i in (0, 2)
    )
    assert first == {1, 2, 3, 4}
    assert second == {5, 6, 7, 8}


def test_a_run_has_its_replay_where_no_picture_can_be_rendered(
    arm_run, tmp_path, monkeypatch
):
    monkeypatch.setattr(frames, "egl_problem", lambda: "libEGL.so.1 is missing")
    engine_named("drake").write_replay(
        arm_run.plan, arm_run.record, tmp_path, ArmOptions()
    )
    assert [path.name for path in tmp_path.iterdir()] == ["replay.html"]
