"""Drive the run loop from a program of your own: progress, an end, and what happened."""

import pushpressslide as pps
from pushpressslide.planar.cell import planar_cell

task = pps.load_task("rear-push-left")
plan = pps.plan(task)
told: list[tuple[float, float]] = []


def progress(time: float, expected: float) -> None:
    """Keep what the loop reports."""
    told.append((time, expected))


options = pps.RunOptions(seed=3, progress=progress, stop=lambda: len(told) > 100)
record = pps.run_loop(planar_cell(plan), plan, options)
print(record)
assert record.reason == "interrupted"  # ``stop`` ended it

whole = pps.run_loop(planar_cell(plan), plan)
print(whole, pps.result(whole)["final_position_error"])
assert pps.result(whole)["success"]
