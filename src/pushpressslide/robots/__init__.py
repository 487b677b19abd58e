"""Robots as arrays: published facts, kinematics both ways, reach and joint paths."""
