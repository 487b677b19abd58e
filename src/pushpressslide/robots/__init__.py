"""Robots as arrays: published facts, forward and inverse kinematics, reach, and joint
paths.
"""
