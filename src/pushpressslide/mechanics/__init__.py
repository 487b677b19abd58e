"""Physics common to all modes: pressure, limit surfaces, friction, contacts
(docs/mechanics.md, sections 0 to 4).
"""

from pushpressslide.core.room import explorable

__getattr__, __dir__ = explorable(__name__)
