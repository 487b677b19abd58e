"""Paths of an object that one arm presses from above."""
