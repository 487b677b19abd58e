"""Tracking laws: closed form, state in and state out, in plain floats."""
