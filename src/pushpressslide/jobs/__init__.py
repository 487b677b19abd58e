"""Jobs behind the commands: one run from task to report, sweeps of many,
identification.
"""
