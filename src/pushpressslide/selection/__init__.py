"""Selection of the mode and its contacts, and the plan of a choice."""
