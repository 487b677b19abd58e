"""The fast engine: quasi-static sliding on a limit surface, without Drake; runs the
same controller.
"""
