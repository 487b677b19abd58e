"""Identification of rho, friction and pressure of a support from motions, and recorded
data sets.
"""
