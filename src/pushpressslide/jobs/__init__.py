"""What a command does: one run from task to report, sweeps of many, identification."""
