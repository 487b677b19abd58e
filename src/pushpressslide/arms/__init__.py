"""Robot arms that turn commands into joint torques, on any model of their dynamics."""
