"""Load a task, choose a mode, plan, run it on the planar engine, and look at the result."""

import pushpressslide as pps

task = pps.load_task("rear-push-rear")  # or the path of a task file of yours
choice = pps.select(task)[0]
plan = pps.plan(task, choice)
record = pps.run(plan, engine="planar")

error = record.figures["final_position_error"]
print(choice)
print(plan)
print(f"success: {record.success}, {1e3 * error:.2f} mm from the goal")

assert record.success
