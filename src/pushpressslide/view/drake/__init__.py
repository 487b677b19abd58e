"""Replays, pictures and the live view of a run."""

import pushpressslide.sim  # noqa: F401  says what to install without Drake
