"""The laws on arrays, with the same leading shape in and out. They are the kernels of
loops, planners and the planar engine, compiled over rows.
"""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
