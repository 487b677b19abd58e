"""Pictures and replays of a run: its course, its play bar, and the views of each
engine.
"""
