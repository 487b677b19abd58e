"""Replays, pictures and the live view of a run."""
