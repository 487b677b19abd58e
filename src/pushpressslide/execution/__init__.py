"""Execution: normal-force regulation, impedance and joint torque, for any mode and
engine.
"""
