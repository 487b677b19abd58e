"""The laws as pure functions of floats and tuples of floats. A control loop calls them
directly, and ``batch`` compiles them over rows.

A kernel reads nothing but its arguments, and never raises. Its arguments are numbers,
followed by tuples of the law's parameters; it returns a tuple. Divisions, roots and
similar operations are guarded, so that they behave the same in Python and compiled.
"""
