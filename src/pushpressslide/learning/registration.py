"""Registration of the environments with Gymnasium."""

from __future__ import annotations

from typing import Any

TASKS = {
    "RearPush": "rear-push-rear",
    "LeftPush": "rear-push-left",
}
"""The shipped task of each environment."""
ENVIRONMENTS: dict[str, dict[str, Any]] = {
    **{f"pushpressslide/{name}-v0": {"task": task} for name, task in TASKS.items()},
    **{
        f"pushpressslide/{name}Exact-v0": {"task": task, "exact": True}
        for name, task in TASKS.items()
    },
}
"""Arguments of the environment behind each registered id."""
COMMANDS: dict[str, dict[str, Any]] = {
    "pushpressslide/Commands-v0": {"task": "press-slide", "engine": "planar"},
    "pushpressslide/CommandsDrake-v0": {"task": "press-slide", "engine": "drake"},
}
"""Arguments of each id whose tips are commanded tick by tick."""
CHOICES: dict[str, dict[str, Any]] = {
    "pushpressslide/ChoosePush-v0": {"task": "rear-push-rear"},
}
"""Arguments of each id with an agent that chooses where to push."""
CHOSEN = "pushpressslide.learning.choice_env:ChoiceEnv"
SINGLE = "pushpressslide.learning.environment:PushEnv"
COMMANDED = "pushpressslide.learning.command_env:CommandEnv"
VECTOR = "pushpressslide.learning.vector:PushVectorEnv"
SLOW = (
    "vectorised environments need numba, which is not installed: "
    "pip install 'pushpressslide[fast]'"
)
MISSING = "gymnasium is not installed: pip install 'pushpressslide[gym]'"


def register() -> None:
    """Register the environments. Does nothing if Gymnasium is not installed."""
    try:
        import gymnasium
    except ImportError:
        return
    for name, arguments in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point=SINGLE,
                vector_entry_point=None if "exact" in arguments else VECTOR,
                kwargs=arguments,
            )
    for ids, entry_point in ((COMMANDS, COMMANDED), (CHOICES, CHOSEN)):
        for name, arguments in ids.items():
            if name not in gymnasium.registry:
                gymnasium.register(id=name, entry_point=entry_point, kwargs=arguments)
