"""From a task file to commands: loading, selection, planning, and the controller (the
paper's Algorithm 1).
"""
