"""The laws on arrays: any leading shape in, the same shape out. Every formula stands once,
for NumPy and for numba.
"""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
