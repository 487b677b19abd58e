"""Published results of others for this benchmark.

Source: model card of lerobot/diffusion_pusht on huggingface.co (revision 8f3b4d8): 500
episodes of a diffusion policy trained on human demonstrations, which sees pictures of
96 by 96 pixels and the position of the pusher. "theirs" is the same model trained with
the code of Chi et al., "Diffusion Policy: Visuomotor Policy Learning via Action
Diffusion", 2023.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Published:
    """Figures of one policy."""

    name: str
    reward: float  # mean of the episodes' greatest
    success: float  # share of the episodes
    episodes: int


PUBLISHED = (
    Published("diffusion, LeRobot", 0.959, 0.638, 500),
    Published("diffusion, authors", 0.957, 0.642, 500),
)
