"""What several modes share, and is none."""
