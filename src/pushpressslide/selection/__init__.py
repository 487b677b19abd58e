"""Which mode, with which contacts: selection, and the plan of a choice."""
