"""Runs of tasks: one task from file to report, and many under random variations."""
