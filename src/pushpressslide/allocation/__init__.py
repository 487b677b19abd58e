"""Allocation: from a wanted object wrench to contact forces inside their cones, in
closed form and plain floats.
"""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
