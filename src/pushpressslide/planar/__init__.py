"""The fast engine: quasi-static sliding on the exact limit surface, without Drake."""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
