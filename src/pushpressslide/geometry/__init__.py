"""Plane geometry of bodies: polygons, outlines, sides, shapes."""
