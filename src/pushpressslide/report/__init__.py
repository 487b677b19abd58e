"""What became of a run: figures, files, plots and pages.

Everything follows from task, plan and record alone.
"""
