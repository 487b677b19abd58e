"""Robots as arrays: published facts, kinematics both ways, reach, joint paths; no
physics engine.
"""
