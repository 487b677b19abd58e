"""Learn a push from demonstrations of our controller: a small network, in NumPy alone."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from pushpressslide.learning.demonstrations import demonstrate
from pushpressslide.learning.push_task import PushTask, push_task
from pushpressslide.learning.pushing import Pushing, drawn_start

Array = np.ndarray
TASK = "rear-push-rear"
SHOWN = range(1000, 1100)  # seeds of the demonstrations
TRIED = range(100)  # seeds of the test: none was shown
HIDDEN, EPOCHS, BATCH, RATE = 64, 60, 512, 3e-3


class Scale(NamedTuple):
    """Mean and standard deviation of columns."""

    mean: Array
    deviation: Array


def scale_of(rows: Array) -> Scale:
    """Return the scale of rows (n, k)."""
    return Scale(rows.mean(axis=0), rows.std(axis=0) + 1e-6)


def turned(vectors: Array, angles: Array) -> Array:
    """Return vectors (n, 2) turned by angles (n,) [rad]."""
    c, s = np.cos(angles), np.sin(angles)
    x, y = vectors.T
    return np.stack([c * x - s * y, s * x + c * y], axis=1)


def seen(states: Array) -> Array:
    """Return goal and tip (n, 6) as seen from the object."""
    place, yaw = states[:, :2], states[:, 2]
    left = states[:, 5] - yaw
    goal = turned(states[:, 3:5] - place, -yaw)
    tip = turned(states[:, 6:8] - place, -yaw)
    return np.column_stack([goal, np.cos(left), np.sin(left), tip])


class Network:
    """Two hidden layers of tanh, fitted to least squares with Adam."""

    def __init__(self, inputs: int, outputs: int, rng: np.random.Generator) -> None:
        sizes = (inputs, HIDDEN, HIDDEN, outputs)
        pairs = list(pairwise(sizes))
        self.weights = [rng.normal(0.0, a**-0.5, (a, b)) for a, b in pairs]
        self.biases = [np.zeros(b) for _, b in pairs]

    def layers(self, x: Array) -> list[Array]:
        out = [x]
        for w, b in zip(self.weights[:-1], self.biases[:-1], strict=True):
            out.append(np.tanh(out[-1] @ w + b))
        return [*out, out[-1] @ self.weights[-1] + self.biases[-1]]

    def slopes(self, x: Array, y: Array) -> list[Array]:
        """The loss by each parameter: weights, then biases."""
        *inner, answer = self.layers(x)
        back = 2.0 * (answer - y) / len(x)
        by_weights: list[Array] = []
        by_biases: list[Array] = []
        for w, h in zip(reversed(self.weights), reversed(inner), strict=True):
            by_weights.insert(0, h.T @ back)
            by_biases.insert(0, back.sum(axis=0))
            back = (back @ w.T) * (1.0 - h * h)
        return [*by_weights, *by_biases]

    def fit(self, x: Array, y: Array, rng: np.random.Generator) -> None:
        parameters = [*self.weights, *self.biases]
        mean = [np.zeros_like(p) for p in parameters]
        square = [np.zeros_like(p) for p in parameters]
        steps = EPOCHS * (len(x) // BATCH)
        rows = np.concatenate([rng.permutation(len(x)) for _ in range(EPOCHS)])
        for k in range(1, steps + 1):
            some = rows[(k - 1) * BATCH : k * BATCH]
            rate = RATE * (1.0 - k / (steps + 1))
            slopes = self.slopes(x[some], y[some])
            for p, g, m, v in zip(parameters, slopes, mean, square, strict=True):
                m += 0.1 * (g - m)
                v += 0.001 * (g * g - v)
                size = np.sqrt(v / (1.0 - 0.999**k)) + 1e-8
                p -= rate * m / (1.0 - 0.9**k) / size


class Learned:
    """A policy that imitates demonstrations."""

    def __init__(self, states: Array, actions: Array, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        x, y = seen(states), turned(actions, -states[:, 2])
        self.inputs, self.outputs = scale_of(x), scale_of(y)
        self.network = Network(x.shape[1], y.shape[1], rng)
        scaled = (y - self.outputs.mean) / self.outputs.deviation
        self.network.fit((x - self.inputs.mean) / self.inputs.deviation, scaled, rng)

    def __call__(self, states: Array) -> Array:
        x = (seen(states) - self.inputs.mean) / self.inputs.deviation
        y = self.network.layers(x)[-1] * self.outputs.deviation + self.outputs.mean
        return turned(y, states[:, 2])


def success_of(policy: Learned, push: PushTask, seeds: range) -> float:
    """Return the share of episodes that reach the goal."""
    pushing = Pushing(push, len(seeds))
    starts = [drawn_start(push, np.random.default_rng(seed)) for seed in seeds]
    pushing.place(np.arange(len(seeds)), starts)
    reached = np.zeros(len(seeds), dtype=bool)
    over = np.zeros(len(seeds), dtype=bool)
    states = pushing.observations()
    for _ in range(push.steps):
        out = pushing.step(policy(states))
        states = out.observations
        reached |= out.success & ~over
        over |= out.terminated
    return float(reached.mean())


def learn(name: str) -> float:
    """Return how often a policy succeeds that has learned a task."""
    push = push_task(name)
    shown = demonstrate(push, SHOWN)
    good = shown.success[shown.episode]
    policy = Learned(shown.states[good], shown.actions[good])
    return success_of(policy, push, TRIED)


if __name__ == "__main__":
    share = learn(TASK)
    print(f"{100.0 * share:.0f} % of {len(TRIED)} new starts reach the goal")
    assert share >= 0.9
