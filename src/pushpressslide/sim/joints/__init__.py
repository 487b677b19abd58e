"""The search for joint paths."""
