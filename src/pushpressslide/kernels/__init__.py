"""The laws as pure functions of floats and tuples of floats: what a control loop calls as
it is, and ``batch`` compiles over rows.

A kernel reads nothing but its arguments, and raises nothing. It takes numbers first, then
the figures of its law as tuples; its answer is a tuple. Divisions, roots and the like
have their guards, so that they mean the same in Python and compiled.
"""
