"""Episodes of a policy, and the file that stores them."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.whole_file import write_whole
from pushpressslide.learning.exact import ExactPushing
from pushpressslide.learning.expert import RearPushPolicy
from pushpressslide.learning.push_task import PERIOD, PushTask
from pushpressslide.learning.pushing import OBSERVATION, Pushing, drawn_start

Progress = Callable[[float, float], None]
Policy = Callable[[Array], Array]
ACTION = ("tip_vx", "tip_vy")
"""What an action holds: the velocity [m/s] of the tip in the world."""
ONE = np.zeros(1, dtype=np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class Demonstrations:
    """Frames of episodes, one after the other. A frame is an observation and the
    policy's action.
    """

    states: Array  # (n, 8) as ``state_names``
    actions: Array  # (n, 2) as ``action_names``
    rewards: Array  # (n,) [m] of the step from the frame
    episode: NDArray[np.int64]  # (n,) the frame's episode
    frame: NDArray[np.int64]  # (n,) its number in that episode
    last_states: Array  # (episodes, 8) after the last frame of each
    success: NDArray[np.bool_]  # (episodes,)
    seed: NDArray[np.int64]  # (episodes,) of the reset
    period: float  # [s] between frames
    task: str  # its name
    state_names: tuple[str, ...] = OBSERVATION
    action_names: tuple[str, ...] = ACTION

    def write(self, path: Path) -> Path:
        """Write all fields as the arrays of a npz file, and return its path."""
        values: dict[str, Any] = {
            field.name: getattr(self, field.name) for field in fields(self)
        }
        data = io.BytesIO()
        np.savez_compressed(data, **values)
        return write_whole(path, data.getvalue())


class _Episode(NamedTuple):
    """Frames and result of one episode."""

    states: Array  # (n + 1, 8)
    actions: Array  # (n, 2)
    rewards: Array  # (n,)
    success: bool


def read_demonstrations(path: Path) -> Demonstrations:
    """Demonstrations from a file written by ``Demonstrations.write``. Raises
    PushPressSlideError for any other file.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            values = {
                field.name: archive[field.name] for field in fields(Demonstrations)
            }
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise PushPressSlideError(
            f"{path}: no demonstrations; allowed: a file that pps demonstrate wrote"
        ) from error
    values["period"] = float(values["period"])
    values["task"] = str(values["task"])
    for name in ("state_names", "action_names"):
        values[name] = tuple(values[name].tolist())
    return Demonstrations(**values)


def demonstrate(
    push: PushTask,
    seeds: Sequence[int],
    progress: Progress | None = None,
    exact: bool = False,
) -> Demonstrations:
    """Demonstrate one episode of mode rear_push for each seed.

    The starts are those of ``environment.PushEnv`` with that seed, on the exact limit
    surface if ``exact``. Raises ValueError without seeds.
    """
    if not seeds:
        raise ValueError("0 seeds give no episode; at least 1 is needed")
    policy = RearPushPolicy(push)
    pushing = ExactPushing(push) if exact else Pushing(push, 1)
    episodes = []
    for done, seed in enumerate(seeds, 1):
        policy.reset()
        pushing.place(ONE, drawn_start(push, np.random.default_rng(seed)))
        episodes.append(_played(pushing, policy))
        if progress is not None:
            progress(done, len(seeds))
    return _joined(push, seeds, episodes)


def _played(pushing: Pushing | ExactPushing, policy: Policy) -> _Episode:
    """Play an episode to its end."""
    states = [pushing.observations()[0]]
    actions = []
    rewards = []
    while True:
        action = policy(states[-1])
        out = pushing.step(action[None])
        states.append(out.observations[0])
        actions.append(action)
        rewards.append(float(out.rewards[0]))
        if out.terminated[0] or out.truncated[0]:
            break
    return _Episode(
        np.array(states),
        np.array(actions),
        np.array(rewards),
        bool(out.success[0]),
    )


def _joined(
    push: PushTask, seeds: Sequence[int], episodes: Sequence[_Episode]
) -> Demonstrations:
    """Episodes one after the other."""
    lengths = [len(one.actions) for one in episodes]
    return Demonstrations(
        states=np.concatenate([one.states[:-1] for one in episodes]),
        actions=np.concatenate([one.actions for one in episodes]),
        rewards=np.concatenate([one.rewards for one in episodes]),
        episode=np.repeat(np.arange(len(lengths)), lengths),
        frame=np.concatenate([np.arange(length) for length in lengths]),
        last_states=np.array([one.states[-1] for one in episodes]),
        success=np.array([one.success for one in episodes]),
        seed=np.array(seeds, dtype=np.int64),
        period=PERIOD,
        task=push.task.name,
    )
