"""Benchmarks of the closed forms against their alternatives."""
