"""Reduced-order models of a pushed or pressed object: car, unicycle or holonomic base."""
