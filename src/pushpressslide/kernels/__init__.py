"""The laws as pure functions of floats and tuples of floats. A control loop calls them
directly, and ``batch`` compiles them over rows.

A kernel reads nothing but its arguments, and raises nothing. It takes numbers first,
then the figures of its law as tuples, and returns a tuple. Divisions, roots and the
like are guarded, so that they mean the same in Python and compiled.
"""
