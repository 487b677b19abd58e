"""The fast engine: quasi-static sliding on the exact limit surface, without Drake."""
