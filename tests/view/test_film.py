"""An animation is written picture by picture, with a caption of the current state."""

import av
import numpy as np
import pytest
from PIL import Image

from pushpressslide.core.errors import MissingPackageError, SimulationError
from pushpressslide.view import film, mp4
from pushpressslide.view.canvas import Canvas, rgba
from pushpressslide.view.film import film_path, film_ticks, moment, write_film
from pushpressslide.view.planar.video import write_video
from pushpressslide.view.timeline import run_timeline


def plain(level):
    return Image.fromarray(np.full((6, 8, 3), level, dtype=np.uint8))


@pytest.mark.parametrize("name", ["a.webp", "a.gif"])
def test_pictures_follow_in_order_as_they_are_drawn(tmp_path, name):
    drawn = []

    def draw(frame):
        drawn.append(frame)
        return plain(60 * frame)

    out = write_film(4, draw, tmp_path / name, 10.0)
    made = Image.open(out)
    assert drawn[:4] == [0, 1, 2, 3]  # at its end Pillow may go back to the first
    assert made.n_frames == 4
    for frame in range(4):
        made.seek(frame)
        level = np.asarray(made.convert("RGB"), dtype=float).mean()
        assert level == pytest.approx(60 * frame, abs=4.0)
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_a_film_of_an_unknown_kind_is_refused(tmp_path):
    with pytest.raises(SimulationError, match=r"\.mp4 or \.webp or \.gif"):
        film_path(tmp_path / "run.avi")


def test_a_folder_gets_an_mp4_or_without_av_a_webp(tmp_path, monkeypatch):
    assert film_path(tmp_path).name == "run.mp4"
    monkeypatch.setattr(film, "has_encoder", lambda: False)
    assert film_path(tmp_path).name == "run.webp"
    monkeypatch.setattr(mp4, "has_encoder", lambda: False)
    with pytest.raises(MissingPackageError, match=r"pushpressslide\[video\]"):
        write_film(2, plain, tmp_path / "run.mp4", 25.0)
    assert not list(tmp_path.iterdir())


def test_an_mp4_holds_every_picture_at_its_time(tmp_path):
    def draw(frame):
        return Image.fromarray(np.full((32, 48, 3), 40 * frame, dtype=np.uint8))

    out = write_film(6, draw, tmp_path / "a.mp4", 25.0)
    with av.open(str(out)) as made:
        frames = list(made.decode(video=0))
    assert [frame.time for frame in frames] == pytest.approx(
        [0.04 * k for k in range(6)]
    )
    assert (frames[0].width, frames[0].height) == (48, 32)
    for k, frame in enumerate(frames):
        level = frame.to_ndarray(format="rgb24").mean()
        assert level == pytest.approx(40 * k, abs=6.0)
    assert [p.name for p in tmp_path.iterdir()] == ["a.mp4"]


def test_pictures_are_taken_at_even_times_to_the_end():
    time = 0.01 * np.arange(401)
    assert film_ticks(time, 2.0) == [0, 50, 100, 150, 200, 250, 300, 350, 400]


def test_the_caption_tells_time_phase_force_and_way_to_the_goal(run):
    told = run_timeline(run.plan, run.record, np.array([0, 200, 449]))
    assert moment(told, 1).startswith("2.0 s   move   force 3.2 N   to the goal ")
    assert moment(told, 2).endswith("to the goal 0 mm, 0°")


def test_two_arms_have_their_forces_told_apart(pressed):
    told = run_timeline(pressed.plan, pressed.record, np.array([200]))
    assert "force left 6.2 N, right 10.2 N" in moment(told, 0)


def test_what_is_seen_through_is_mixed_with_what_is_under_it():
    canvas = Canvas(np.full((20, 20, 3), 255, dtype=np.uint8))
    corners = [(2.0, 2.0), (18.0, 2.0), (18.0, 18.0), (2.0, 18.0)]
    canvas.polygon(corners, rgba("#000000", 0.5), rgba("#000000"), 1.0)
    made = np.asarray(canvas.image())
    assert made[10, 10] == pytest.approx([127, 127, 127], abs=2)
    assert list(made[0, 0]) == [255, 255, 255]


def test_the_planar_run_is_filmed_with_the_object_on_its_way(run, tmp_path):
    out = write_video(
        run.plan,
        run.record,
        tmp_path / "run.webp",
        frames_per_second=1.0,
        size=(320, 180),
    )
    made = Image.open(out)
    assert (made.n_frames, made.size) == (5, (320, 180))
    first = np.asarray(made.convert("RGB"), dtype=float)
    made.seek(4)
    last = np.asarray(made.convert("RGB"), dtype=float)
    assert np.abs(first - last).max() > 50.0
