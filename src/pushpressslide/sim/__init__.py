"""The physics engine: the only package that imports pydrake."""
