"""Pictures and replays of a run: its timeline, its play bar, and the views of each
engine.
"""
