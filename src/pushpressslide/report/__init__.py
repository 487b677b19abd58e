"""What became of a run: figures, files, plots and pages, from task, plan and record
alone.
"""
