"""The closed-form controller, for any mode and any plant."""
