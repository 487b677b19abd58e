"""Search for joint paths, on top of any library of rigid bodies."""
