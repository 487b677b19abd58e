"""The environments that Gymnasium is told of."""

from __future__ import annotations

ENVIRONMENTS = {
    "pushpressslide/RearPush-v0": "rear-push-rear",
    "pushpressslide/LeftPush-v0": "rear-push-left",
}
"""The shipped task of each registered id."""
SINGLE = "pushpressslide.learning.environment:PushEnv"
VECTOR = "pushpressslide.learning.vector:PushVectorEnv"
MISSING = "gymnasium is not installed: pip install 'pushpressslide[gym]'"


def register() -> None:
    """Register the environments; nothing happens where Gymnasium is not installed."""
    try:
        import gymnasium
    except ImportError:
        return
    for name, task in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point=SINGLE,
                vector_entry_point=VECTOR,
                kwargs={"task": task},
            )
