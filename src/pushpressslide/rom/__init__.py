"""Reduced-order models: the car, unicycle or holonomic base that a pushed or pressed
object moves like.
"""
