"""The laws as pure functions of floats and tuples of floats. A control loop calls them
directly, and ``batch`` compiles them over rows.

A kernel depends only on its arguments, and never raises. The arguments are numbers,
followed by tuples of the law's parameters. The result is a tuple. Divisions, roots and
similar operations are guarded, so that they behave the same in Python and compiled.
"""
