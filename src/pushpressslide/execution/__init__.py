"""Execution: normal-force regulation, impedance, joint torque. Arrays in, arrays out;
knows nothing of modes or engines.
"""
