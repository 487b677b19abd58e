"""Physics true for any mode: pressure, limit surfaces, friction, contacts. See
docs/mechanics.md, 0 to 4.
"""
