"""What a support does to an object, found from its motions: rho, friction, pressure;
recorded data sets.
"""
