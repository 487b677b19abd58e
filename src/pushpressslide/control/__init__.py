"""The controller, closed form, for any mode and any plant."""
