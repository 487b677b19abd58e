"""Allocation: from a wanted object wrench to contact forces inside their cones, closed
form, in plain floats.
"""
