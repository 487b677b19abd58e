"""Rho, friction and pressure of a support, found from motions; recorded data sets."""
