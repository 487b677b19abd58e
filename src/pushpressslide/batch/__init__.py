"""The laws on arrays: any leading shape in, the same shape out. Every formula stands once,
for NumPy and for numba.
"""
