"""Pictures of a pushed object."""

import numpy as np

from pushpressslide.learning import picture
from pushpressslide.learning.picture import Camera
from pushpressslide.learning.push_task import push_task


def test_what_is_seen_is_as_large_and_where_it_is() -> None:
    push = push_task("rear-push-rear")
    side = 400
    camera = Camera(push, side)
    observation = np.array([0.4, 0.1, 0.3, 0.66, -0.2, -0.35, 0.3, 0.3])
    seen = camera.picture(observation)
    x = np.broadcast_to(camera._x, (side, side))
    y = np.broadcast_to(camera._y, (side, side))
    pixel = (x[0, 1] - x[0, 0]) ** 2

    def covered(*colours: tuple[int, int, int]) -> np.ndarray:
        return np.any([(seen == colour).all(axis=2) for colour in colours], axis=0)

    body = covered(picture.OBJECT, picture.HEADING)
    assert abs(body.sum() * pixel - 0.15**2) < 3e-4
    assert abs(x[body].mean() - 0.4) < 1e-3
    assert abs(y[body].mean() - 0.1) < 1e-3
    goal = covered(picture.GOAL)
    assert abs(x[goal].mean() - 0.66) < 1e-3
    dot = covered(picture.HEADING)
    heading = np.arctan2(y[dot].mean() - 0.1, x[dot].mean() - 0.4)
    assert abs(heading - 0.3) < 0.02
    assert abs(covered(picture.TIP).sum() * pixel - np.pi * 0.02**2) < 2e-4
