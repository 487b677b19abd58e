"""Episodes of a policy, and the file that stores them."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.learning.command_rows import command_names, state_names
from pushpressslide.learning.exact import ExactPushing
from pushpressslide.learning.expert import RearPushPolicy
from pushpressslide.learning.push_task import PERIOD, PushTask
from pushpressslide.learning.pushing import OBSERVATION, Pushing, drawn_start, errors
from pushpressslide.modes.rear_push import MODE

if TYPE_CHECKING:
    from pushpressslide.learning.command_env import CommandEnv

Progress = Callable[[float, float], None]
Policy = Callable[[Array], Array]
ACTION = ("tip_vx", "tip_vy")
"""Names of an action's values: the velocity [m/s] of the tip in the world."""
ONE = np.zeros(1, dtype=np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class Demonstrations:
    """Frames of all episodes in sequence. A frame is an observation and the policy's
    action.
    """

    # (n, 8), or (n, 7 + 9 A) for commanded tips; columns as in ``state_names``
    states: Array
    # (n, 2), or (n, 25 A) for commanded tips; columns as in ``action_names``
    actions: Array
    rewards: Array  # (n,) [m] reward of the step from the frame
    episode: NDArray[np.int64]  # (n,) the frame's episode
    frame: NDArray[np.int64]  # (n,) the frame's number in that episode
    last_states: Array  # (episodes, ...) states after the last frame of each
    success: NDArray[np.bool_]  # (episodes,)
    reason: NDArray[np.str_]  # (episodes,) why it failed; empty for a success
    seed: NDArray[np.int64]  # (episodes,) seed of the reset
    period: float  # [s] between frames
    task: str  # name of the task
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

    states: Array  # (n + 1, ...)
    actions: Array  # (n, ...)
    rewards: Array  # (n,)
    reason: str  # why it failed; empty for a success


def read_demonstrations(path: Path) -> Demonstrations:
    """Demonstrations from a file written by ``Demonstrations.write``. Raises
    PushPressSlideError for any other file.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            values = {
                field.name: archive[field.name]
                for field in fields(Demonstrations)
                if field.name in archive or field.name != "reason"
            }
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise PushPressSlideError(
            f"{path}: no demonstrations; allowed: a file that pps demonstrate wrote"
        ) from error
    # missing in older files
    values.setdefault("reason", np.full(len(values["seed"]), ""))
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

    The starts are those of ``environment.PushEnv`` with the same seed. With ``exact``
    the object is on its exact limit surface. Raises ValueError without seeds.
    """
    _check_seeds(seeds)
    policy = RearPushPolicy(push)
    pushing = ExactPushing(push) if exact else Pushing(push, 1)
    episodes = []
    for done, seed in enumerate(seeds, 1):
        policy.reset()
        pushing.place(ONE, drawn_start(push, np.random.default_rng(seed)))
        episodes.append(_played(pushing, policy))
        if progress is not None:
            progress(done, len(seeds))
    return _joined(push.task.name, seeds, episodes)


def _check_seeds(seeds: Sequence[int]) -> None:
    if not seeds:
        raise ValueError("0 seeds give no episode; at least 1 is needed")


def demonstrate_commands(
    task: Task, seeds: Sequence[int], progress: Progress | None = None
) -> Demonstrations:
    """Demonstrate one episode of the task's best mode for each seed, tick by tick.

    The episodes are those of ``command_env.CommandEnv`` on the planar engine. Raises
    InfeasibleTaskError if no plan leads from a start to the goal, ImportError without
    Gymnasium, and ValueError without seeds.
    """
    from pushpressslide.learning.command_env import CommandEnv
    from pushpressslide.learning.mode_policy import ModePolicy

    _check_seeds(seeds)
    env = CommandEnv(task)
    policy = ModePolicy(env)
    episodes = []
    for done, seed in enumerate(seeds, 1):
        first, _ = env.reset(seed=seed)
        policy.reset()
        episodes.append(_commanded(env, policy, first))
        if progress is not None:
            progress(done, len(seeds))
    names = (state_names(len(task.robots)), command_names(len(task.robots)))
    period = task.motion.control_period
    return _joined(task.name, seeds, episodes, period, *names)


def _commanded(env: CommandEnv, policy: Policy, first: Array) -> _Episode:
    """Play an episode of ``CommandEnv`` to its end."""
    states = [first]
    actions = []
    rewards = []
    over = False
    while not over:
        action = policy(states[-1])
        state, reward, terminated, truncated, info = env.step(action)
        states.append(state)
        actions.append(action)
        rewards.append(reward)
        over = terminated or truncated
    reason = ""
    if not info["success"]:
        late = f"{env.task.limits.time:g} s, limits.time, are over"
        cause = env.loop.cell.clock.failure() or late
        reason = f"{cause}, {_away(info['distance'], info['angle'])}"
    return _Episode(np.array(states), np.array(actions), np.array(rewards), reason)


def _away(distance: float, angle: float) -> str:
    """Text on an episode's final errors in position [m] and angle [rad]."""
    return f"{1e3 * distance:.0f} mm and {math.degrees(angle):.0f} deg from the goal"


def _played(pushing: Pushing | ExactPushing, policy: RearPushPolicy) -> _Episode:
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
    reason = ""
    if not out.success[0]:
        cause = "the tip has passed an end of its face"
        if out.truncated[0]:
            time = PERIOD * len(actions)
            cause = (
                f"{time:.1f} s, the longest time, are over (its path takes "
                f"{policy.duration:.1f} s)"
            )
        distance, angle = errors(out.observations)
        reason = f"{cause}, {_away(float(distance[0]), float(angle[0]))}"
        if policy.refusal is not None:
            reason += f"; {MODE.name} refuses this start: {policy.refusal}"
    return _Episode(np.array(states), np.array(actions), np.array(rewards), reason)


def _joined(
    task: str,
    seeds: Sequence[int],
    episodes: Sequence[_Episode],
    period: float = PERIOD,
    state_names: tuple[str, ...] = OBSERVATION,
    action_names: tuple[str, ...] = ACTION,
) -> Demonstrations:
    """Demonstrations of several episodes, joined."""
    lengths = [len(one.actions) for one in episodes]
    return Demonstrations(
        states=np.concatenate([one.states[:-1] for one in episodes]),
        actions=np.concatenate([one.actions for one in episodes]),
        rewards=np.concatenate([one.rewards for one in episodes]),
        episode=np.repeat(np.arange(len(lengths)), lengths),
        frame=np.concatenate([np.arange(length) for length in lengths]),
        last_states=np.array([one.states[-1] for one in episodes]),
        success=np.array([not one.reason for one in episodes]),
        reason=np.array([one.reason for one in episodes]),
        seed=np.array(seeds, dtype=np.int64),
        period=period,
        task=task,
        state_names=state_names,
        action_names=action_names,
    )
