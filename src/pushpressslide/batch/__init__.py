"""The laws on arrays, with the same leading shape in and out. They use the same kernels
as control loops, planners and the planar engine, compiled over rows.
"""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
