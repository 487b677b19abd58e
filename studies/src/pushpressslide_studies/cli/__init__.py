"""Commands of the studies. ``pps`` finds them by their entry points."""
