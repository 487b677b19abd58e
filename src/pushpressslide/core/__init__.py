"""Nouns of the flow, as frozen data: poses, wrenches, tasks, choices, plans,
allocations, records.
"""
