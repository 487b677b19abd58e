"""The search for joint paths, by what any library of rigid bodies knows of an arm."""
