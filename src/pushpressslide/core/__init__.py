"""Core types of the data flow, as frozen data: poses, wrenches, tasks, choices, plans,
allocations, records.
"""
