"""Physics that is true for any mode: pressure, limit surfaces, friction, contacts.

docs/mechanics.md, sections 0 to 4.
"""
