"""What the replays of every engine share: the course of a run and its play bar."""
