"""Pages and films of runs on the planar engine."""
