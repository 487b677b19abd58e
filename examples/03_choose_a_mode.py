"""Let every mode compete for one task, and see why the others lost."""

from dataclasses import replace

import pushpressslide as pps

task = replace(pps.load_task("press-slide"), modes=None)
choices = pps.select(task)
for choice in choices[:8]:
    print(f"{choice.mode:24} {choice.verdict:12} {choice.reason}")

best = choices[0]
assert best.feasible
print(f"taken: {best.mode}, about {best.time:.1f} s")
