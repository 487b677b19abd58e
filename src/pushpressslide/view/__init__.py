"""What a run looks like: its course, its play bar, and pictures of each engine."""
